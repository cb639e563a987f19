// `ecs test thermal`: how a displacement follows several temperatures over several warm-ups, judged by runs left out.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "commissioning/measurements/files.hpp"
#include "modules/standards/thermal_law.hpp"

namespace ecs::app {
namespace {

struct ThermalRequest {
  std::string file;
  ImportArguments import;
  static Fields<ThermalRequest> fields() {
    using R = ThermalRequest;
    return {{"FILE", &R::file, "file of readings at one place over several runs, with time_s and temperatures",
             Need::required},
            &R::import};
  }
};

Cell term_cell(const laser::ThermalTerm& term) {
  return record_cell("    {um_per_degC:>9} um/degC  {sensor}{lag}\n", "um_per_degC"_is(term.um_per_degC, 3),
                     "sensor"_is(term.sensor), "lag_s"_is(term.lag_s),
                     "lag"_shown(term.lag_s > 0.0 ? fmt::format(", delayed by {:.3g} s", term.lag_s) : std::string()));
}

Cell law_cell(const std::string& title, const laser::ThermalLaw& law) {
  return record_cell("  {title:<49} {rms_um:>15} {left_out_rms_um:>12}\n", "title"_shown(title),
                     "rms_um"_is(law.rms_um, 2), "left_out_rms_um"_is(law.left_out_rms_um, 2),
                     "terms"_is(list_cell(law.terms, term_cell)), "run_rms_um"_is(Json(law.run_rms_um)));
}

Cell run_cell(const laser::ThermalTest& test, std::size_t r) {
  const laser::ThermalRun& run = test.runs[r];
  return record_cell(
      "  {run:>5} {readings:>8} {plain:>9} {lagged:>8} {plain_shape:>9} {lagged_shape:>8}{words}\n", "run"_is(run.run),
      "readings"_is(run.readings), "plain"_shown(test.plain.run_rms_um[r], 2),
      "lagged"_shown(test.lagged.run_rms_um[r], 2), "plain_shape"_shown(test.plain_shape.run_rms_um[r], 2),
      "lagged_shape"_shown(test.lagged_shape.run_rms_um[r], 2), "extrapolates"_is(!run.beyond.empty()),
      "beyond"_is(Json(run.beyond)),
      "words"_shown(run.beyond.empty() ? std::string() : fmt::format("  {}", fmt::join(run.beyond, ", "))));
}

/// What lowers the error of a run left out, with the numbers.
std::string answer_words(const laser::ThermalTest& test) {
  constexpr double kWorthIt = 0.9;  // a tenth less
  const double plain = test.plain.left_out_rms_um, lagged = test.lagged.left_out_rms_um;
  const double shape = test.plain_shape.left_out_rms_um, lagged_shape = test.lagged_shape.left_out_rms_um;
  std::string words;
  if (lagged < kWorthIt * plain)
    words += fmt::format("Delays of the sensors lower the error of a run left out from {:.2f} to {:.2f} um. ", plain,
                         lagged);
  if (shape < kWorthIt * plain)
    words += fmt::format("A zero of its own for each run lowers it from {:.2f} to {:.2f} um. ", plain, shape);
  if (lagged_shape < kWorthIt * shape) words += fmt::format("Both together lower it to {:.2f} um. ", lagged_shape);
  if (words.empty())
    return "Neither delays nor a zero for each run predict the left-out runs better than the present temperatures.";
  words.pop_back();
  return words;
}

Result<Outcome> thermal(VerbContext& context, const ThermalRequest& request) {
  ECS_TRY(imported, read_with_notes(context.console, request.file, request.import));
  ECS_TRY(test, laser::thermal_test_of(imported.set));
  std::vector<std::size_t> runs(test.runs.size());
  for (std::size_t r = 0; r < runs.size(); ++r) runs[r] = r;
  return outcome_of(
      record_cell("{file}: {count} runs; deviation from the first reading of each run {raw_rms_um} um rms\n"
                  "  rms [um]                                          all runs fitted run left out\n"
                  "{plain}{lagged}{plain_shape}{lagged_shape}"
                  "  law with a delay for each sensor and a separate zero of each run:\n{law}"
                  "  each run predicted by the others, rms [um]\n"
                  "                 from first reading  own zero each run\n"
                  "    run readings  no delay  delayed  no delay  delayed  beyond other runs [degC]\n{runs}{words}\n",
                  "file"_is(request.file), "count"_shown(test.runs.size()), "raw_rms_um"_is(test.raw_rms_um, 2),
                  "plain"_is(law_cell("all sensors, from the first reading", test.plain)),
                  "lagged"_is(law_cell("sensors and delays chosen, from the first reading", test.lagged)),
                  "plain_shape"_is(law_cell("all sensors, own zero of each run", test.plain_shape)),
                  "lagged_shape"_is(law_cell("sensors and delays chosen, own zero of each run", test.lagged_shape)),
                  "law"_shown(list_cell(test.lagged_shape.terms, term_cell).text),
                  "runs"_is(list_cell(runs, [&](std::size_t r) { return run_cell(test, r); })),
                  "words"_shown(answer_words(test)), "answer"_is(answer_words(test))));
}

}  // namespace

extern const std::vector<Action> kTestsOfHeat{action(
    "test thermal", "law by which a displacement follows several temperatures, tested on runs left out of its fit",
    "ecs test thermal warm_ups.csv", thermal, {.logged = Logged::always, .kind = "test"})};

}  // namespace ecs::app
