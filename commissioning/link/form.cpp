#include "commissioning/link/form.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::commissioning {
namespace {

const std::vector<std::string> kKinds{"serial line", "network (TCP)", "emulator"};
const std::vector<std::string> kBaudChoices{"1200",  "2400",   "4800",   "9600",   "19200", "38400",
                                            "57600", "115200", "230400", "460800", "921600"};
const std::vector<std::string> kFormats{"8N1", "8E1", "8O1", "8N2", "8E2"};
constexpr const char* kUnitHelp = "Modbus unit number, 1 to 247; a new unit has 1";

}  // namespace

LinkForm::LinkForm(const LinkChoice& choice) {
  if (const auto* emulator = std::get_if<EmulatorLink>(&choice.link)) {
    kind_ = LinkKind::emulator;
    machine_ = emulator->machine.string();
    return;
  }
  const auto& address = std::get<protocol::LinkAddress>(choice.link);
  unit_ = fmt::format("{}", address.unit);
  if (const auto* line = std::get_if<protocol::SerialPort>(&address.endpoint)) {
    device_ = line->device;
    baud_ = fmt::format("{}", line->baud);
    format_ = fmt::format("8{}{}", line->parity, line->stop_bits);
  } else {
    const auto& peer = std::get<protocol::TcpPeer>(address.endpoint);
    kind_ = LinkKind::network;
    host_ = peer.host;
    port_ = fmt::format("{}", peer.port);
    token_ = peer.token_file;
  }
}

std::vector<LinkField> LinkForm::fields(const std::vector<std::string>& ports) const {
  std::vector<LinkField> rows{{"link", kKinds[static_cast<std::size_t>(kind_)], kKinds, "how the unit is reached"}};
  switch (kind_) {
    case LinkKind::serial:
      rows.push_back({"port", device_, ports, "the serial port; the list below shows those of this computer"});
      rows.push_back({"baud", baud_, kBaudChoices, "as set in the unit; most have 115200 or 9600"});
      rows.push_back({"format", format_, kFormats, "data bits, parity (N none, E even, O odd), stop bits"});
      rows.push_back({"unit", unit_, {}, kUnitHelp});
      break;
    case LinkKind::network:
      rows.push_back({"host", host_, {}, "name or address of the converter or the unit"});
      rows.push_back({"TCP port", port_, {}, "502 for Modbus"});
      rows.push_back({"unit", unit_, {}, kUnitHelp});
      rows.push_back({"token", token_, {}, "file with the unit's token; needed beyond this computer"});
      break;
    case LinkKind::emulator:
      rows.push_back({"machine", machine_, {}, "machine file of the emulator; empty: the sample mill"});
      break;
  }
  return rows;
}

void LinkForm::set(int row, const std::string& typed) {
  const std::string value(trimmed(typed));
  if (row == 0) {
    const auto found = std::find(kKinds.begin(), kKinds.end(), value);
    if (found != kKinds.end()) kind_ = static_cast<LinkKind>(found - kKinds.begin());
    return;
  }
  std::vector<std::string*> values;
  if (kind_ == LinkKind::serial) values = {&device_, &baud_, &format_, &unit_};
  if (kind_ == LinkKind::network) values = {&host_, &port_, &unit_, &token_};
  if (kind_ == LinkKind::emulator) values = {&machine_};
  if (row <= static_cast<int>(values.size())) *values[static_cast<std::size_t>(row - 1)] = value;
}

void LinkForm::step(int row, int by, const std::vector<std::string>& ports) {
  const auto rows = fields(ports);
  if (row < 0 || row >= static_cast<int>(rows.size())) return;
  const LinkField& field = rows[static_cast<std::size_t>(row)];
  const auto count = static_cast<int>(field.choices.size());
  if (count == 0) return;
  const auto found = std::find(field.choices.begin(), field.choices.end(), field.value);
  const int now = found == field.choices.end() ? (by > 0 ? -1 : 0) : static_cast<int>(found - field.choices.begin());
  set(row, field.choices[static_cast<std::size_t>((now + by + count) % count)]);
}

std::string LinkForm::text() const {
  if (kind_ == LinkKind::emulator) return machine_.empty() ? "emulator" : "emulator:" + machine_;
  if (kind_ == LinkKind::serial) return fmt::format("rtu:{}:{}:{}:{}", device_, baud_, format_, unit_);
  const bool bare = host_.find(':') != std::string::npos && !host_.starts_with('[');  // IPv6
  const std::string token = token_.empty() ? "" : "?token=" + token_;
  return bare ? fmt::format("tcp:[{}]:{}:{}{}", host_, port_, unit_, token)
              : fmt::format("tcp:{}:{}:{}{}", host_, port_, unit_, token);
}

}  // namespace ecs::commissioning
