#include "commissioning/models/what_if.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/paragraph.hpp"
#include "commissioning/models/view.hpp"

namespace ecs::commissioning {
namespace {

Result<std::optional<Achieved>> achieved(MessageSink& messages, const ModelWork& work,
                                         const std::vector<std::string>& after, const ImportArguments& import) {
  if (after.empty()) return std::optional<Achieved>();
  auto set = measured_in(messages, after, import);
  if (!set) return tl::unexpected(set.error());
  const std::size_t all = set->readings.size();
  std::erase_if(set->readings, [](const laser::Reading& r) { return !r.compensated.value_or(true); });
  if (set->readings.empty())
    return tl::unexpected(Problem{ProblemKind::bad_input,
                                  "expected readings taken with compensation active (compensated = 1), found none",
                                  after.front(),
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

std::string shares_text(const WhatIfAnswer& answer) {
  std::string text = fmt::format("{} {:>9}  {}\n", padded("effect", 34), "rms [um]", "carried by");
  for (const model::WhatIf::Share& share : answer.what.shares)
    text += paragraph_after(fmt::format("{} {:>9.3f}  ", padded(share.effect, 34), share.rms_um),
                            (share.carried ? "" : "NOT CARRIED: ") + share.how);
  return text;
}

std::string directions_text(const WhatIfAnswer& answer) {
  std::string text = "sense axis direction   readings   now [um]  predicted";
  text += answer.achieved ? "   achieved   of predicted\n" : "\n";
  for (const AfterDirection& one : answer.directions) {
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

}  // namespace

Result<WhatIfAnswer> what_if_answer(MessageSink& messages, const ModelWork& work, const std::string& model_file,
                                    const std::vector<std::string>& after, const ImportArguments& import) {
  auto again = achieved(messages, work, after, import);
  if (!again) return tl::unexpected(again.error());
  const auto fit = model::fit(work.model, work.data);
  if (!fit) return tl::unexpected(in_file(fit.error(), model_file));
  const auto what = model::what_if(work.model, work.data);
  if (!what) return tl::unexpected(in_file(what.error(), model_file));
  return WhatIfAnswer{*what, after_by_direction(*fit, work.data, *again ? (**again).data : model::Observations{}),
                      *again, notes_on(work, *again)};
}

std::string what_if_text(const WhatIfAnswer& answer) {
  std::string text =
      paragraph(fmt::format("Compensating all that the unit can would bring the rms from {:.3f} to {:.3f} um (peak "
                            "{:.3f} um), noise included.",
                            answer.what.rms_now_um, answer.what.rms_after_um, answer.what.peak_after_um));
  if (answer.achieved)
    text +=
        paragraph(fmt::format("Measured again: {} readings, rms {:.3f} um (peak {:.3f} um): {:.2f} times what was "
                              "predicted.",
                              answer.achieved->data.size(), answer.achieved->rms_um, answer.achieved->peak_um,
                              answer.achieved->rms_um / std::max(1e-12, answer.what.rms_after_um)));
  return text + "\n" + shares_text(answer) + "\n" + directions_text(answer) + notes_text(answer.notes);
}

}  // namespace ecs::commissioning
