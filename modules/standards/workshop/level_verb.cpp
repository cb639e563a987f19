// The verb `level`, which the module brings to the emulator: a cut surface surveyed with an electronic level.

#include "base/file.hpp"
#include "ecs_emulator/verbs/module.hpp"
#include "modules/standards/workshop/level_survey.hpp"

namespace ecs::emulator {
namespace {

struct LevelRequest {
  std::string trace, output, plane = "XZ";
  std::vector<double> from_mm, to_mm;
  FaceCut cut;
  LevelSurvey survey;
  bool force = false;
  static Fields<LevelRequest> fields() {
    using R = LevelRequest;
    using S = LevelSurvey;
    const auto of_survey = [](const char* name, auto S::*member, const char* help, auto... more) {
      return Fields<R>(&R::survey, Fields<S>(name, member, help, more...));
    };
    const auto corner = [](const char* name, std::vector<double> R::*member, const char* help) {
      cli::Argument argument{name, {}, help, Need::required};
      argument.by_commas = true;
      return Fields<R>(std::move(argument), [member](R& request) {
        return cli::OnNumbers([&request, member](const std::vector<double>& given_mm) { request.*member = given_mm; });
      });
    };
    return {{"TRACE", &R::trace, "trace of the part program that cut the surface (run --trace)", Need::required},
            {"--plane", &R::plane, "the axes of the surface (XZ): east is the first, north the second",
             Words{"XY", "XZ", "YZ"}},
            corner("--from", &R::from_mm, "south-west corner of the survey, along both axes of the plane [mm]"),
            corner("--to", &R::to_mm, "north-east corner of the survey [mm]"),
            Fields<R>(&R::cut,
                      Fields<FaceCut>("--at", &FaceCut::at_mm,
                                      "commanded coordinate of the surface along the third axis [mm]", Need::required)),
            Fields<R>(&R::cut, Fields<FaceCut>("--cutter", &FaceCut::cutter_mm, "diameter of the face cutter [mm]",
                                               cli::Range{1.0, 1000.0})),
            of_survey("--step", &S::foot_mm, "distance of the feet of the level [mm]", cli::Range{1.0, 1000.0}),
            of_survey("--noise", &S::noise_um_per_m, "standard deviation of a reading [um/m]", cli::Range{0.0, 1000.0}),
            of_survey("--seed", &S::seed, "seed of the noise and of the inclination of the part"),
            {"-o,--output", &R::output, "file of readings to write (.csv), for `ecs test flatness`", cli::Is::output,
             Need::required},
            {"--force", &R::force, "overwrite an existing file"}};
  }
};

Result<Outcome> survey_cut_surface(VerbContext& /*context*/, const LevelRequest& request) {
  if (request.from_mm.size() != 2 || request.to_mm.size() != 2)
    return problem(ProblemKind::usage, "--from and --to: expected two coordinates each, such as -2950,-875");
  ECS_DO(spared({request.output}, request.force));
  ECS_TRY(text, read_file(request.trace));
  FaceCut cut = request.cut;
  for (std::size_t i = 0; i < 2; ++i) cut.plane[i] = static_cast<Axis>(request.plane[i] - 'X');
  LevelSurvey survey = request.survey;
  survey.south_west_mm = {request.from_mm[0], request.from_mm[1]};
  survey.north_east_mm = {request.to_mm[0], request.to_mm[1]};
  ECS_TRY(surface, CutSurface::parse(text, request.trace, cut));
  ECS_TRY(readings, survey_with_level(surface, cut, survey));
  ECS_DO(write_file(request.output, readings));
  return Outcome{};
}

const std::vector<Action> kLevel{
    action("level", "survey a cut surface with an electronic level along the eight lines of a union jack",
           "ecs-emulator workshop shop.sock run flat_xz.nc --trace flat.csv --trace-period 0.1\n"
           "  ecs-emulator level flat.csv --at -1200 --from -2950,-875 --to -1150,-125 -o survey.csv\n"
           "  ecs test flatness survey.csv",
           survey_cut_surface)};

}  // namespace

const Module& standards_emulator_module() {
  static const Module module{{"program", &kLevel}};
  return module;
}

}  // namespace ecs::emulator
