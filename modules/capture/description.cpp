#include "modules/capture/description.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/toml_reader.hpp"
#include "base/words.hpp"

namespace ecs::devices {
namespace {

constexpr WordTable<DeviceKind, 3> kKinds{{"trigger", "environment", "gauge"}};
constexpr WordTable<Quantity, 5> kQuantities{
    {"air_degC", "material_degC", "pressure_hPa", "humidity_pct", "reading_um"}};

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += std::string("\\") + c;
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
      out += fmt::format("\\u{:04X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    else
      out += c;
  }
  return out + "\"";
}

std::string list_of(const Bytes& bytes) {
  std::string out;
  for (const std::uint8_t byte : bytes) out += fmt::format("{}0x{:02x}", out.empty() ? "" : ", ", byte);
  return "[" + out + "]";
}

std::string report_text(const ReportLayout& report) {
  std::string text = "\n[report]\n";
  if (report.feature) text += "type = \"feature\"\n";
  if (report.number != 0) text += fmt::format("id = {}\n", report.number);
  if (report.bytes != 0) text += fmt::format("length = {}\n", report.bytes);
  if (!report.poll.empty()) text += fmt::format("poll = {}\n", list_of(report.poll));
  if (report.poll_number != 0) text += fmt::format("poll_id = {}\n", report.poll_number);
  if (report.replies != 1) text += fmt::format("replies = {}\n", report.replies);
  return text + fmt::format("timeout_ms = {}\n", report.timeout_ms);
}

std::string field_text(const ReportField& field) {
  std::string text = fmt::format(
      "\n[[field]]\nquantity = \"{}\"\nbyte = {}\nlength = {}\norder = \"{}\"\nsigned = {}\n", name_of(field.quantity),
      field.byte, field.bytes, field.big_endian ? "big" : "little", field.is_signed);
  text += fmt::format("scale = {}\noffset = {}\n", shortest(field.scale), shortest(field.offset));
  if (field.absent) text += fmt::format("absent = {}\n", *field.absent);
  if (!field.starts.empty()) text += fmt::format("starts = {}\n", list_of(field.starts));
  return text;
}

bool starts_with(const Bytes& report, const Bytes& head) {
  return report.size() >= head.size() && std::equal(head.begin(), head.end(), report.begin());
}

std::optional<std::int64_t> raw_in(const ReportField& field, const Bytes& report) {
  const auto count = static_cast<std::size_t>(field.bytes);
  if (report.size() < field.byte + count) return std::nullopt;
  std::uint64_t raw = 0;
  for (std::size_t k = 0; k < count; ++k) raw = raw << 8U | report[field.byte + (field.big_endian ? k : count - 1 - k)];
  const std::uint64_t top = std::uint64_t{1} << (8 * count - 1);
  const auto value = static_cast<std::int64_t>(raw);
  return field.is_signed && (raw & top) != 0 ? value - static_cast<std::int64_t>(top << 1U) : value;
}

const Bytes* reply_of(const ReportField& field, const std::vector<Bytes>& replies) {
  if (field.starts.empty()) return replies.empty() ? nullptr : &replies.front();
  const auto found =
      std::ranges::find_if(replies, [&](const Bytes& reply) { return starts_with(reply, field.starts); });
  return found == replies.end() ? nullptr : &*found;
}

}  // namespace

std::string_view name_of(DeviceKind kind) { return kKinds.of(kind); }
std::string_view name_of(Quantity quantity) { return kQuantities.of(quantity); }

std::string to_toml(const DeviceDescription& device) {
  std::string text = fmt::format("name = {}\nkind = \"{}\"\n", quoted(device.name), name_of(device.kind));
  if (!device.source.empty()) text += fmt::format("source = {}\n", quoted(device.source));
  text += "\n[match]\n";
  if (!device.match.ids.empty())
    text += fmt::format("vendor_id = 0x{:04x}\nproduct_id = 0x{:04x}\n", device.match.ids.front().vendor_id,
                        device.match.ids.front().product_id);
  if (device.match.serial) text += fmt::format("serial = {}\n", quoted(*device.match.serial));
  if (device.match.path) text += fmt::format("path = {}\n", quoted(*device.match.path));
  if (device.match.interface) text += fmt::format("interface = {}\n", *device.match.interface);
  if (device.match.usage_page) text += fmt::format("usage_page = 0x{:04x}\n", *device.match.usage_page);
  text += report_text(device.report);
  if (device.kind == DeviceKind::trigger)
    text +=
        fmt::format("\n[trigger]\nbyte = {}\nmask = 0x{:02x}\nactive = \"{}\"\ndebounce_ms = {}\n", device.trigger.byte,
                    device.trigger.mask, device.trigger.active_high ? "high" : "low", device.trigger.debounce_ms);
  for (const ReportField& field : device.fields) text += field_text(field);
  return text;
}

std::optional<bool> held_in(const DeviceDescription& device, const Bytes& report) {
  if (device.report.number != 0 && (report.empty() || report[0] != device.report.number)) return std::nullopt;
  if (report.size() <= device.trigger.byte) return std::nullopt;
  const std::uint8_t mask = device.trigger.mask;
  const auto bits = static_cast<std::uint8_t>(report[device.trigger.byte] & mask);
  return bits == (device.trigger.active_high ? mask : 0);
}

Values values_in(const DeviceDescription& device, const std::vector<Bytes>& replies) {
  Values values;
  for (const ReportField& field : device.fields) {
    const Bytes* reply = reply_of(field, replies);
    const auto raw = reply == nullptr ? std::nullopt : raw_in(field, *reply);
    if (!raw || raw == field.absent) continue;
    values.emplace(field.quantity, static_cast<double>(*raw) * field.scale + field.offset);
  }
  return values;
}

namespace {

constexpr double kMostFactor = 1e12;  ///< of scale and offset: a choice

class DeviceReader {
 public:
  explicit DeviceReader(const std::string& file) : reader_(file) {}

  Result<DeviceDescription> read(std::string_view text) {
    ECS_TRY(table, reader_.parsed(text));
    reader_.only(table, {"name", "kind", "source", "match", "report", "trigger", "field"}, "a device");
    DeviceDescription out;
    out.file = reader_.file();
    out.name = reader_.word(table, "name").value_or("");
    if (out.name.empty()) reader_.complain(1, "name: expected a name in quotes, as in name = \"foot switch\"");
    out.source = reader_.word(table, "source").value_or("");
    out.kind = kind_of(table);
    read_match(table, out.match);
    if (const toml::table* report = reader_.child(table, "report")) read_report(*report, out.report);
    read_trigger(table, out);
    read_fields(table, out);
    if (!reader_.clean()) return tl::unexpected(reader_.all());
    return out;
  }

 private:
  DeviceKind kind_of(const toml::table& table) {
    const std::string word = reader_.word(table, "kind").value_or("");
    if (const auto kind = kKinds.value_of(word)) return *kind;
    reader_.complain(table, "kind: expected one of {}, got \"{}\"", kKinds.listed(), word);
    return DeviceKind::trigger;
  }

  std::optional<long long> whole(const toml::table& table, std::string_view key, long long least, long long most) {
    const auto value = reader_.number(table, key);
    if (!value) return std::nullopt;
    if (*value == std::floor(*value) && *value >= static_cast<double>(least) && *value <= static_cast<double>(most))
      return static_cast<long long>(*value);
    reader_.complain(*table.get(key), "{}: expected a whole number from {} to {}", key, least, most);
    return std::nullopt;
  }

  /// One of two words, the usual one where there is none. @return whether it is the other
  bool is_other(const toml::table& table, std::string_view key, std::string_view usual, std::string_view other) {
    const std::string word = reader_.word(table, key).value_or(std::string(usual));
    if (word != usual && word != other)
      reader_.complain(*table.get(key), "{}: expected {} or {}, got \"{}\"", key, usual, other, word);
    return word == other;
  }

  std::optional<bool> yes_or_no(const toml::table& table, std::string_view key) {
    const toml::node* node = table.get(key);
    if (node == nullptr) return std::nullopt;
    if (const auto* value = node->as_boolean()) return value->get();
    reader_.complain(*node, "{}: expected true or false", key);
    return std::nullopt;
  }

  Bytes bytes_of(const toml::table& table, std::string_view key) {
    Bytes out;
    const toml::node* node = table.get(key);
    if (node == nullptr) return out;
    const toml::array* array = node->as_array();
    if (array == nullptr || array->size() > 1024) {
      reader_.complain(*node, "{}: expected a list of bytes, as in [0x01, 0x80]", key);
      return out;
    }
    for (const toml::node& each : *array) {
      const auto value = each.is_integer() ? each.value<std::int64_t>() : std::nullopt;
      if (!value || *value < 0 || *value > 255) {
        reader_.complain(each, "{}: expected bytes from 0x00 to 0xff", key);
        return out;
      }
      out.push_back(static_cast<std::uint8_t>(*value));
    }
    return out;
  }

  void read_match(const toml::table& table, DeviceMatch& match) {
    const toml::table* at = reader_.child(table, "match");
    if (at == nullptr) return reader_.complain(1, "[match] is missing: expected at least vendor_id and product_id");
    reader_.only(*at, {"vendor_id", "product_id", "serial", "path", "interface", "usage_page"}, "[match]");
    const auto vendor = whole(*at, "vendor_id", 0, 0xFFFF);
    const auto product = whole(*at, "product_id", 0, 0xFFFF);
    if (!vendor || !product)
      reader_.complain(*at, "[match]: expected vendor_id and product_id, as `ecs laser devices` lists them");
    match.ids.push_back(
        {static_cast<std::uint16_t>(vendor.value_or(0)), static_cast<std::uint16_t>(product.value_or(0))});
    match.serial = reader_.word(*at, "serial");
    match.path = reader_.word(*at, "path");
    if (const auto number = whole(*at, "interface", 0, 255)) match.interface = static_cast<int>(*number);
    if (const auto page = whole(*at, "usage_page", 0, 0xFFFF)) match.usage_page = static_cast<std::uint16_t>(*page);
  }

  void read_report(const toml::table& at, ReportLayout& report) {
    reader_.only(at, {"type", "id", "length", "poll", "poll_id", "replies", "timeout_ms"}, "[report]");
    report.feature = is_other(at, "type", "input", "feature");
    report.number = static_cast<std::uint8_t>(whole(at, "id", 0, 255).value_or(0));
    report.bytes = static_cast<std::size_t>(whole(at, "length", 1, 4096).value_or(0));
    report.poll = bytes_of(at, "poll");
    report.poll_number = static_cast<std::uint8_t>(whole(at, "poll_id", 0, 255).value_or(0));
    report.replies = static_cast<int>(whole(at, "replies", 1, 16).value_or(1));
    report.timeout_ms = static_cast<int>(whole(at, "timeout_ms", 1, 10'000).value_or(500));
    if (report.feature && report.bytes == 0) reader_.complain(at, "[report]: a feature report needs its length");
  }

  void read_trigger(const toml::table& table, DeviceDescription& out) {
    const toml::table* at = reader_.child(table, "trigger");
    if ((at != nullptr) != (out.kind == DeviceKind::trigger))
      reader_.complain(table, at == nullptr
                                  ? "[trigger] is missing: expected byte and bit (or mask)"
                                  : fmt::format("[trigger] does not belong to a device of kind {}", name_of(out.kind)));
    if (at == nullptr) return;
    reader_.only(*at, {"byte", "bit", "mask", "active", "debounce_ms"}, "[trigger]");
    const auto byte = whole(*at, "byte", 0, 4095);
    const auto bit = whole(*at, "bit", 0, 7);
    const auto mask = whole(*at, "mask", 1, 255);
    if (!byte) reader_.complain(*at, "[trigger]: byte is missing: the byte of the report that contains the button");
    if (bit.has_value() == mask.has_value())
      reader_.complain(*at, "[trigger]: expected either bit (0 to 7) or mask (1 to 255)");
    out.trigger.byte = static_cast<std::size_t>(byte.value_or(0));
    out.trigger.mask = static_cast<std::uint8_t>(mask ? *mask : 1LL << bit.value_or(0));
    out.trigger.active_high = !is_other(*at, "active", "high", "low");
    out.trigger.debounce_ms = static_cast<int>(whole(*at, "debounce_ms", 0, 5000).value_or(30));
    if (out.report.feature) reader_.complain(table, "[report]: a trigger sends input reports");
  }

  void read_fields(const toml::table& table, DeviceDescription& out) {
    const auto fields = reader_.children(table, "field");
    if (out.kind == DeviceKind::trigger && !fields.empty())
      reader_.complain(table, "[[field]] does not belong to a device of kind trigger");
    if (out.kind != DeviceKind::trigger && fields.empty())
      reader_.complain(table, "[[field]] is missing: expected one for each number, with quantity and byte");
    for (const toml::table* each : fields) out.fields.push_back(field(*each, out));
    if (out.kind == DeviceKind::gauge && fields.size() > 1) reader_.complain(table, "a gauge has one [[field]]");
  }

  ReportField field(const toml::table& at, const DeviceDescription& device) {
    reader_.only(at, {"quantity", "byte", "length", "order", "signed", "scale", "offset", "absent", "starts"},
                 "[[field]]");
    ReportField out;
    out.quantity = quantity_of(at, device.kind);
    const auto byte = whole(at, "byte", 0, 4095);
    if (!byte) reader_.complain(at, "[[field]]: byte is missing: the first byte of the number in the report");
    out.byte = static_cast<std::size_t>(byte.value_or(0));
    out.bytes = static_cast<int>(whole(at, "length", 1, 4).value_or(2));
    out.big_endian = is_other(at, "order", "little", "big");
    out.is_signed = yes_or_no(at, "signed").value_or(true);
    out.scale = reader_.number(at, "scale").value_or(1.0);
    if (out.scale == 0.0) reader_.complain(at, "scale: expected a number other than 0");
    out.offset = reader_.number(at, "offset").value_or(0.0);
    for (const auto& [key, value] : {std::pair{"scale", out.scale}, std::pair{"offset", out.offset}})
      if (std::abs(value) > kMostFactor)
        reader_.complain(*at.get(key), "{}: expected a number within {}, got {}", key, kMostFactor, value);
    out.absent = whole(at, "absent", -2147483648LL, 4294967295LL);
    out.starts = bytes_of(at, "starts");
    if (device.report.bytes != 0 && out.byte + static_cast<std::size_t>(out.bytes) > device.report.bytes)
      reader_.complain(at, "[[field]]: bytes {} to {} are beyond the report of {} bytes", out.byte,
                       out.byte + static_cast<std::size_t>(out.bytes) - 1, device.report.bytes);
    return out;
  }

  Quantity quantity_of(const toml::table& at, DeviceKind kind) {
    const std::string word = reader_.word(at, "quantity").value_or("");
    const auto quantity = kQuantities.value_of(word);
    if (quantity && (quantity == Quantity::reading_um) == (kind == DeviceKind::gauge)) return *quantity;
    reader_.complain(
        at, kind == DeviceKind::gauge
                ? fmt::format("quantity: expected reading_um, got \"{}\"", word)
                : fmt::format("quantity: expected air_degC, material_degC, pressure_hPa or humidity_pct, got \"{}\"",
                              word));
    return Quantity::air_degC;
  }

  TomlReader reader_;
};

}  // namespace

Result<DeviceDescription> parse_device(std::string_view text, const std::string& file) {
  return DeviceReader(file).read(text);
}

Result<DeviceDescription> read_device(const std::filesystem::path& path) {
  ECS_TRY(text, read_file(path));
  return parse_device(text, path.string());
}

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
      "= 19.31 degC)";
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

std::string udev_rule(std::uint16_t vendor_id, std::uint16_t product_id) {
  return fmt::format(
      "KERNEL==\"hidraw*\", ATTRS{{idVendor}}==\"{:04x}\", ATTRS{{idProduct}}==\"{:04x}\", MODE=\"0660\", "
      "GROUP=\"plugdev\", TAG+=\"uaccess\"",
      vendor_id, product_id);
}

std::string udev_rules(const std::vector<DeviceDescription>& devices) {
  std::string text =
      "# HID devices of the workshop, for ECS. Save as /etc/udev/rules.d/70-ecs.rules, then run:\n"
      "#   sudo udevadm control --reload && sudo udevadm trigger\n"
      "# Keep the number below 73: the tag uaccess is evaluated by the rules with that number.\n";
  std::vector<std::string> written;
  for (const DeviceDescription& device : devices)
    for (const DeviceMatch::Ids& ids : device.match.ids) {
      const std::string rule = udev_rule(ids.vendor_id, ids.product_id);
      if (std::ranges::find(written, rule) != written.end()) continue;
      written.push_back(rule);
      text += fmt::format("# {}\n{}\n", device.name, rule);
    }
  return text;
}

}  // namespace ecs::devices
