#include "devices/builtin.hpp"

namespace ecs::devices {
namespace {

/// All sticks of the family answer to this on their second interface (TEMPered wiki; temper.py).
const Bytes kQuery{0x01, 0x80, 0x33, 0x01, 0x00, 0x00, 0x00, 0x00};
constexpr std::size_t kReply = 8;

ReportField temperature(Quantity quantity, std::size_t byte, double scale, std::int64_t absent, Bytes starts) {
  return {quantity, byte, 2, true, true, scale, 0.0, absent, std::move(starts)};
}

DeviceDescription temper() {
  DeviceDescription out;
  out.kind = DeviceKind::environment;
  out.match.interface = 1;
  out.report.bytes = kReply;
  out.report.poll = kQuery;
  out.report.timeout_ms = 800;
  return out;
}

/// Reply 80 02 HH LL … (one sensor) or 80 04 HH LL hh ll … (two): degrees in 256ths; ff ff where no sensor is.
DeviceDescription fm75() {
  DeviceDescription out = temper();
  out.name = "temper-fm75";
  out.source =
      "github.com/edorfaus/TEMPered wiki and issues 17, 32; github.com/urwen/temper pull request 21 (8002135065723146 "
      "= "
      "19.31 degC)";
  out.match.ids = {{0x0C45, 0x7401}};
  out.fields = {temperature(Quantity::air_degC, 2, 1.0 / 256.0, -1, {}),
                temperature(Quantity::material_degC, 4, 1.0 / 256.0, -1, {0x80, 0x04})};
  return out;
}

/// Reply 80 xx TT TT HH HH 00 00, hundredths of a degree and of a percent, 4e 20 where no sensor is; a stick with a
/// probe on a cable sends 80 01 TT TT 4e 20 00 00 besides.
DeviceDescription hundredths() {
  DeviceDescription out = temper();
  out.name = "temper-hundredths";
  out.source =
      "github.com/edorfaus/TEMPered issue 51; github.com/ccwienk/temper pull requests 8 (8080085f4e200000 "
      "8001078b4e200000 = 21.43 and 19.31 degC), 45 (8020090111930000 = 23.05 degC) and issue 31";
  out.match.ids = {{0x413D, 0x2107}, {0x1A86, 0xE025}, {0x3553, 0xA001}};
  out.report.replies = 2;
  out.fields = {temperature(Quantity::air_degC, 2, 0.01, 20000, {}),
                {Quantity::humidity_pct, 4, 2, true, true, 0.01, 0.0, 20000, {}},
                temperature(Quantity::material_degC, 2, 0.01, 20000, {0x80, 0x01})};
  return out;
}

}  // namespace

const std::vector<DeviceDescription>& builtin_devices() {
  static const std::vector<DeviceDescription> devices{fm75(), hundredths()};
  return devices;
}

std::vector<DeviceDescription> builtin_named(const std::string& name) {
  std::vector<DeviceDescription> found;
  for (const DeviceDescription& device : builtin_devices())
    if (name == "temper" || name == device.name) found.push_back(device);
  return found;
}

}  // namespace ecs::devices
