// Circular tests: the polar plot, the values of ISO 230-4 and the causes ranked by their share.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/report/sections.hpp"
#include "app/report/svg.hpp"
#include "commissioning/standards/circle.hpp"

namespace ecs::app {
namespace {

constexpr int kCircleDecimals = 1;  ///< um
constexpr const char* kCirclesTitle = "Circular tests (ISO 230-4)";

Markup centre_cell(const std::array<double, 2>& centre_um) {
  return text(
      fmt::format("{}, {}", number_text(centre_um[0], kCircleDecimals), number_text(centre_um[1], kCircleDecimals)));
}

Markup values_table(const CircleWork& circle) {
  TableMarkup table({{"path"},
                     {"run", true},
                     {"G", true},
                     {"F max", true},
                     {"F min", true},
                     {"H", true},
                     {"D", true},
                     {"centre", true},
                     {"unit"}});
  for (const laser::CirclePass& pass : circle.values.passes)
    table.row({text(pass.clockwise ? "clockwise" : "counter-clockwise"), text(fmt::format("{}", pass.run)),
               cell(pass.G_um, kCircleDecimals), cell(pass.F_max_um, kCircleDecimals),
               cell(pass.F_min_um, kCircleDecimals), cell(std::nullopt, 0), cell(std::nullopt, 0),
               centre_cell(pass.centre_um), text("µm")});
  for (const laser::CirclePair& pair : circle.values.pairs)
    table.row({text("both"), text(fmt::format("{}", pair.clockwise_run)), cell(pair.G_um, kCircleDecimals),
               cell(std::nullopt, 0), cell(std::nullopt, 0), cell(pair.H_um, kCircleDecimals),
               cell(pair.D_um, kCircleDecimals), centre_cell(pair.centre_um), text("µm")});
  return table.markup();
}

/// Of spikes how long they are, with twice its standard uncertainty as in the column beside.
std::string decay_text(const model::CircleFaultFound& fault) {
  if (!fault.nonlinear_sigma_mm) return {};
  return fmt::format(", decay {:.3g} ± {:.2g} mm", fault.nonlinear_mm, 2.0 * *fault.nonlinear_sigma_mm);
}

Markup causes_table(const model::CircleDiagnosis& diagnosis) {
  TableMarkup table({{"cause"}, {"share", true}, {"size", true}, {"±", true}, {"unit"}, {"cannot be told from"}});
  for (const model::CircleFaultFound& fault : diagnosis.faults)
    table.row({element("strong", fault.title) + text(decay_text(fault)),
               text(fmt::format("{:.0f} %", 100.0 * fault.share)), text(number_text(fault.value, kCircleDecimals)),
               text(number_text(2.0 * fault.sigma, kCircleDecimals)), text(unit_text(fault.unit)),
               text(first_few(fault.indistinguishable_from))});
  return table.markup();
}

Markup circle_markup(const CircleWork& circle) {
  const model::CircleDiagnosis& diagnosis = circle.diagnosis;
  std::string head = fmt::format("{}, plane {}, radius {} mm", circle.file.filename().string(),
                                 laser::plane_name(circle.test.plane), plain_number(circle.test.radius_mm));
  if (circle.test.feed_mm_min) head += fmt::format(", {} mm/min", plain_number(*circle.test.feed_mm_min));
  Markup body = element("h3", head) + Markup::literal("\n");
  body += element("figure", inline_svg(polar_figure(circle.test, circle.values))) + values_table(circle);
  if (diagnosis.faults.empty()) return body + paragraph_of("No fault of a circle stands out of the noise.");
  return body + causes_table(diagnosis) +
         paragraph_of(fmt::format("Deviations of {} rms about the centre, of which {} are left; noise of a reading {}. "
                                  "± is twice the standard uncertainty.",
                                  quantity_text(diagnosis.rms_um, 2, "um"), quantity_text(diagnosis.left_um, 2, "um"),
                                  quantity_text(diagnosis.noise_um, 2, "um")),
                      "class=\"small\"") +
         list_of(without_commands(diagnosis.notes));
}

}  // namespace

ReportSection circles_section(const ReportContent& content) {
  Markup body;
  for (const CircleWork& circle : content.circles) body += circle_markup(circle);
  return {"circles", kCirclesTitle, body, "no circular test was given"};
}

}  // namespace ecs::app
