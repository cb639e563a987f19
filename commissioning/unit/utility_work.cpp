#include "commissioning/unit/utility_work.hpp"

#include <cmath>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "commissioning/unit/status.hpp"
#include "core/bytes.hpp"
#include "core/fault.hpp"

namespace ecs::commissioning {
namespace {

constexpr double kLeastMeasured = 0.02;  ///< of what was put out; less is no movement
constexpr double kScaleHolds = 0.02;     ///< of the scale; a dial gauge knows no better

}  // namespace

Result<AxisTest> test_datum_of(protocol::UnitClient& client, Axis axis, std::chrono::milliseconds limit,
                               const protocol::CommandCallback& busy) {
  const auto result = client.test_datum(axis, limit, busy);
  if (result) return AxisTest{axis, true, {}};
  const auto failure = client.link().last_failure();
  if (failure != protocol::LinkFailure::none || client.link().cancelled()) return tl::unexpected(result.error());
  ECS_TRY(status, client.status());
  const protocol::AxisStatus& state = status.axes[index_of(axis)];
  std::string message = result.error().message;
  if (state.datum_failure != DatumFailure::none)
    message += fmt::format(" ({}: {})", ecs::name_of(state.datum_failure), advice_for(state.datum_failure));
  return AxisTest{axis, false, std::move(message), state.datum_failure};
}

Result<void> begin_compensation(protocol::UnitClient& client) {
  auto entered = client.enter_compensation();
  if (entered) return {};
  Problem failure = std::move(entered.error());
  if (client.link().last_failure() == protocol::LinkFailure::none && !client.link().cancelled() &&
      failure.message.find(protocol::text_of(protocol::UnitError::not_armed)) == std::string::npos)
    if (const auto status = client.status(); status && status->fault != Fault::none)
      failure.message = "the unit cannot compensate: " + fault_sentence(*status);
  return tl::unexpected(std::move(failure));
}

std::string um_text(double um) { return um == 0.0 ? "0 um" : fmt::format("{:+g} um", um); }

Result<ScaleProposal> scale_from(const AxisParameters& axis, Axis name, double um, double measured_um) {
  if (um == 0.0)
    return problem(ProblemKind::usage,
                   "first output a value with the relay closed: 0 um gives no information about the scale");
  if (std::abs(measured_um) < kLeastMeasured * std::abs(um))
    return problem(ProblemKind::usage,
                   "output {}, measured {}: the axis does not follow. Check the relay, "
                   "the connection to the servo, and the D/A converter",
                   um_text(um), um_text(measured_um));
  ScaleProposal proposal;
  proposal.counts_per_um = axis.output_scale_counts_per_um * std::abs(um / measured_um);
  const bool turned = (um > 0.0) != (measured_um > 0.0);
  proposal.polarity = turned ? -axis.compensation_polarity : axis.compensation_polarity;
  const std::string seen = fmt::format("output {} moved {} by {}", um_text(um), letter_of(name), um_text(measured_um));
  if (!turned && std::abs(proposal.counts_per_um / axis.output_scale_counts_per_um - 1.0) < kScaleHolds)
    proposal.sentence = seen + ": scale and polarity are correct.";
  else
    proposal.sentence = fmt::format(
        "{}: set the compensation output value scaling factor of {} to {:.4g} counts/um (it is {:.4g}){} in E.C.S. "
        "PARAMETERS, send them, and try again.",
        seen, letter_of(name), proposal.counts_per_um, axis.output_scale_counts_per_um,
        turned ? fmt::format(" and its compensation polarity to {:+d}", proposal.polarity) : "");
  return proposal;
}

Result<std::vector<KeptRegister>> kept_registers(protocol::UnitClient& client) {
  ECS_TRY(bytes, client.read_memory(kUserRegisters, kUserRegisterBytes));
  std::vector<KeptRegister> kept;
  for (std::size_t i = 0; i < kUserRegisterBytes / 4; ++i)
    kept.push_back({i < 16 ? fmt::format("{}{}", i < 8 ? 'D' : 'A', i % 8) : (i == 16 ? "PC" : "SR"),
                    load_big<std::uint32_t>(bytes, 4 * i)});
  return kept;
}

Cell registers_cell(const std::vector<KeptRegister>& registers) {
  Cell cell;
  for (std::size_t i = 0; i < registers.size(); ++i) {
    cell.json[registers[i].name] = registers[i].value;
    cell.text += fmt::format("{} {:08X}{}", registers[i].name, registers[i].value,
                             i % 4 == 3 || i + 1 == registers.size() ? "\n" : "   ");
  }
  return cell;
}

std::string registers_text(const std::vector<KeptRegister>& registers) { return registers_cell(registers).text; }

}  // namespace ecs::commissioning
