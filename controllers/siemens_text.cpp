// SINUMERIK 840D, the text of the tables.
#include <fmt/format.h>

#include "base/units.hpp"
#include "controllers/siemens_tables.hpp"

namespace ecs::controllers {
namespace {

constexpr int kDigits = 6;  ///< of mm: one nanometre

std::string grid_lines(std::string_view variable, const std::string& index, const EvenGrid& grid) {
  const double last = grid.first_mm + grid.step_mm * static_cast<double>(grid.points - 1);
  return fmt::format("{0}_STEP[{1}]={2:.{5}f}\n{0}_MIN[{1}]={3:.{5}f}\n{0}_MAX[{1}]={4:.{5}f}\n", variable, index,
                     grid.step_mm, grid.first_mm, last, kDigits);
}

/// The error in mm that a compensation stands for.
std::string value_text(double compensation_um) {
  const std::string text = fmt::format("{:.{}f}", -compensation_um / kUmPerMm, kDigits);
  return text.find_first_not_of("-0.") == std::string::npos && text.front() == '-' ? text.substr(1) : text;
}

}  // namespace

std::string encoder_text(const std::vector<SiemensTable>& tables, const SiemensOptions& options) {
  std::string text =
      "%_N_AX_EEC_INI\n; value = error in mm: a positive value moves the axis in the negative direction\n";
  for (const SiemensTable& table : tables)
    text += fmt::format("; needs MD38000 $MA_MM_ENC_COMP_MAX_POINTS[{},{}] of at least {}\n", options.encoder,
                        options.axis_name[index_of(table.input)], table.grid.points);
  text += "; load with MD32700 $MA_ENC_COMP_ENABLE = 0\nCHANDATA(1)\n";
  for (const SiemensTable& table : tables) {
    const std::string axis = options.axis_name[index_of(table.input)];
    const std::string index = fmt::format("{},{}", options.encoder, axis);
    text += fmt::format("; {} {}\n", table.name, table.comment) + grid_lines("$AA_ENC_COMP", index, table.grid);
    text += fmt::format("$AA_ENC_COMP_IS_MODULO[{}]=0\n", index);
    for (std::size_t k = 0; k < table.compensation_um.size(); ++k)
      text +=
          fmt::format("$AA_ENC_COMP[{},{},{}]={}\n", options.encoder, k, axis, value_text(table.compensation_um[k]));
  }
  return text + "M17\n";
}

std::string cross_text(const std::vector<SiemensTable>& tables, const SiemensOptions& options) {
  std::string needs, body;
  for (std::size_t t = 0; t < tables.size(); ++t) {
    const SiemensTable& table = tables[t];
    needs += fmt::format("; needs MD18342 $MN_MM_CEC_MAX_POINTS[{}] of at least {}\n", t, table.grid.points);
    body += fmt::format("; table {}: {} {}\n", t, table.name, table.comment);
    body += fmt::format("$AN_CEC_INPUT_AXIS[{0}]=({1})\n$AN_CEC_OUTPUT_AXIS[{0}]=({2})\n", t,
                        options.axis_name[index_of(table.input)], options.axis_name[index_of(table.output)]);
    body += grid_lines("$AN_CEC", std::to_string(t), table.grid);
    body += fmt::format("$AN_CEC_DIRECTION[{0}]={1}\n$AN_CEC_MULT_BY_TABLE[{0}]=0\n$AN_CEC_IS_MODULO[{0}]=0\n", t,
                        table.direction);
    for (std::size_t k = 0; k < table.compensation_um.size(); ++k)
      body += fmt::format("$AN_CEC[{},{}]={}\n", t, k,
                          value_text(table.compensation_um[k] * (options.cec_adds ? -1.0 : 1.0)));
  }
  return fmt::format("%_N_NC_CEC_INI\n; value in mm: a positive value moves the output axis in the {} direction\n",
                     options.cec_adds ? "positive" : "negative") +
         needs + "; load with MD32710 $MA_CEC_ENABLE = 0\nCHANDATA(1)\n" + body + "M17\n";
}

}  // namespace ecs::controllers
