// `ecs model what-if`: the error that compensation would leave; measured again, predicted against achieved.
#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "app/model_after.hpp"
#include "app/model_json.hpp"
#include "app/model_menu.hpp"
#include "app/model_view.hpp"
#include "app/model_work.hpp"
#include "app/paragraph.hpp"
#include "model/ladder.hpp"

namespace ecs::app {
namespace {

struct Arguments {
  ModelArguments common;
  std::vector<std::string> after;
};

/// What was measured with the unit compensating.
struct Achieved {
  model::Observations data;
  double rms_um = 0.0;
  double peak_um = 0.0;
  std::size_t left_out = 0;  ///< readings marked as taken without compensation
};

Result<std::optional<Achieved>> achieved(Session& session, const ModelWork& work, const Arguments& arguments) {
  if (arguments.after.empty()) return std::optional<Achieved>();
  auto set = measured_in(session, arguments.after, arguments.common.import);
  if (!set) return tl::unexpected(set.error());
  const std::size_t all = set->readings.size();
  std::erase_if(set->readings, [](const laser::Reading& r) { return !r.compensated.value_or(true); });
  if (set->readings.empty())
    return tl::unexpected(Problem{ProblemKind::bad_input,
                                  "expected readings taken with compensation active (compensated = 1), found none",
                                  arguments.after.front(),
                                  0,
                                  0,
                                  {}});
  Achieved out{model::observations_of(*set, work.model, work.machine), 0.0, 0.0, all - set->readings.size()};
  double square = 0.0;
  for (const double reading : out.data.reading) {
    square += reading * reading;
    out.peak_um = std::max(out.peak_um, std::abs(reading));
  }
  out.rms_um = std::sqrt(square / static_cast<double>(out.data.size()));
  return std::optional(std::move(out));
}

/// Everything the answer tells.
struct Told {
  model::WhatIf what;
  std::vector<AfterDirection> directions;
  std::optional<Achieved> achieved;
  std::vector<std::string> notes;
};

std::string shares_text(const Told& told) {
  std::string text = fmt::format("{} {:>9}  {}\n", padded("effect", 34), "rms [um]", "carried by");
  for (const model::WhatIf::Share& share : told.what.shares)
    text += paragraph_after(fmt::format("{} {:>9.3f}  ", padded(share.effect, 34), share.rms_um),
                            (share.carried ? "" : "NOT CARRIED: ") + share.how);
  return text;
}

std::string directions_text(const Told& told) {
  std::string text = "sense axis direction   readings   now [um]  predicted";
  text += told.achieved ? "   achieved   of predicted\n" : "\n";
  for (const AfterDirection& one : told.directions) {
    text += fmt::format("{:<5} {:<4} {:<11} {:>8} {:>10.3f} {:>10.3f}", name_of(one.sense), letter_of(one.axis),
                        direction_text(one.approach), one.readings, one.now_um, one.predicted_um);
    if (one.achieved_um) {
      text += fmt::format(" {:>10.3f}", *one.achieved_um);
      if (one.predicted_um > 0.0) text += fmt::format(" {:>12.2f} x", *one.achieved_um / one.predicted_um);
    }
    text += "\n";
  }
  return text;
}

std::string text_of(const Told& told) {
  std::string text =
      paragraph(fmt::format("Compensating all that the unit can would bring the rms from {:.3f} to {:.3f} um (peak "
                            "{:.3f} um), noise included.",
                            told.what.rms_now_um, told.what.rms_after_um, told.what.peak_after_um));
  if (told.achieved)
    text +=
        paragraph(fmt::format("Measured again: {} readings, rms {:.3f} um (peak {:.3f} um): {:.2f} times what was "
                              "predicted.",
                              told.achieved->data.size(), told.achieved->rms_um, told.achieved->peak_um,
                              told.achieved->rms_um / std::max(1e-12, told.what.rms_after_um)));
  return text + "\n" + shares_text(told) + "\n" + directions_text(told) + notes_text(told.notes);
}

Json json_of_told(const Told& told) {
  Json effects = Json::array(), directions = Json::array();
  for (const model::WhatIf::Share& share : told.what.shares)
    effects.push_back({{"effect", share.effect},
                       {"rms_um", number_or_null(share.rms_um)},
                       {"carried", share.carried},
                       {"how", share.how}});
  for (const AfterDirection& one : told.directions)
    directions.push_back({{"sense", name_of(one.sense)},
                          {"axis", axis_json(one.axis)},
                          {"approach", one.approach},
                          {"rms_now_um", number_or_null(one.now_um)},
                          {"rms_after_um", number_or_null(one.predicted_um)},
                          {"achieved_rms_um", number_or_null(one.achieved_um)},
                          {"readings", one.readings},
                          {"readings_after", one.readings_after}});
  Json object{{"rms_now_um", number_or_null(told.what.rms_now_um)},
              {"rms_after_um", number_or_null(told.what.rms_after_um)},
              {"peak_after_um", number_or_null(told.what.peak_after_um)},
              {"effects", std::move(effects)},
              {"directions", std::move(directions)},
              {"achieved", nullptr},
              {"notes", told.notes}};
  if (told.achieved)
    object["achieved"] = {{"rms_um", number_or_null(told.achieved->rms_um)},
                          {"peak_um", number_or_null(told.achieved->peak_um)},
                          {"readings", told.achieved->data.size()},
                          {"of_predicted", number_or_null(told.achieved->rms_um / told.what.rms_after_um)}};
  return object;
}

std::vector<std::string> notes_on(const ModelWork& work, const std::optional<Achieved>& after) {
  std::vector<std::string> notes;
  const auto compensated = std::count(work.data.compensated.begin(), work.data.compensated.end(), true);
  if (compensated > 0)
    notes.push_back(
        fmt::format("{} of the {} readings were taken with compensation active: for them this is what a "
                    "further map would leave",
                    compensated, work.data.size()));
  if (after && after->left_out > 0)
    notes.push_back(fmt::format("{} readings of --after are marked compensated = 0 and left out", after->left_out));
  return notes;
}

Result<Outcome> what_if(Session& session, const Arguments& arguments) {
  const auto work = model_work(session, arguments.common);
  if (!work) return tl::unexpected(work.error());
  auto after = achieved(session, *work, arguments);
  if (!after) return tl::unexpected(after.error());
  const auto fit = model::fit(work->model, work->data);
  if (!fit) return tl::unexpected(in_file(fit.error(), arguments.common.model));
  const auto what = model::what_if(work->model, work->data);
  if (!what) return tl::unexpected(in_file(what.error(), arguments.common.model));
  const Told told{*what, after_by_direction(*fit, work->data, *after ? (**after).data : model::Observations{}), *after,
                  notes_on(*work, *after)};
  return Outcome{text_of(told), one_line(json_of_told(told)), kDone};
}

}  // namespace

void add_model_what_if(Menu& menu) {
  const auto arguments = std::make_shared<Arguments>();
  Verb verb = menu.verb("what-if", "the error that compensation would leave; predicted against achieved",
                        "ecs model what-if model.toml before.csv --machine machine.toml --after measured_again.csv");
  take_model_and_data(verb, arguments->common);
  verb.texts("--after", arguments->after, "the same measured again with the unit compensating");
  verb.runs([arguments](Session& session) { return what_if(session, *arguments); });
}

}  // namespace ecs::app
