#include "laser/units.hpp"

#include <algorithm>
#include <array>

#include "base/text.hpp"

namespace ecs::laser {
namespace {

constexpr double kZero_K = 273.15;

constexpr std::array<Unit, 37> kUnits{{
    {"mm", UnitKind::length, 1.0},
    {"um", UnitKind::length, 1e-3},
    {"\xC2\xB5m", UnitKind::length, 1e-3},  // micro sign
    {"\xCE\xBCm", UnitKind::length, 1e-3},  // Greek mu
    {"nm", UnitKind::length, 1e-6},
    {"cm", UnitKind::length, 10.0},
    {"m", UnitKind::length, 1000.0},
    {"in", UnitKind::length, 25.4},
    {"inch", UnitKind::length, 25.4},
    {"mil", UnitKind::length, 0.0254},
    {"thou", UnitKind::length, 0.0254},
    {"uin", UnitKind::length, 25.4e-6},
    {"um/m", UnitKind::angle, 1.0},
    {"urad", UnitKind::angle, 1.0},
    {"mm/m", UnitKind::angle, 1000.0},
    {"mrad", UnitKind::angle, 1000.0},
    {"rad", UnitKind::angle, 1e6},
    {"deg", UnitKind::angle, kUmPerMPerDegree},
    {"arcmin", UnitKind::angle, kUmPerMPerDegree / 60.0},
    {"arcsec", UnitKind::angle, kUmPerMPerDegree / 3600.0},
    {"degC", UnitKind::temperature, 1.0},
    {"C", UnitKind::temperature, 1.0},
    {"degF", UnitKind::temperature, 5.0 / 9.0, -160.0 / 9.0},
    {"F", UnitKind::temperature, 5.0 / 9.0, -160.0 / 9.0},
    {"K", UnitKind::temperature, 1.0, -kZero_K},
    {"hPa", UnitKind::pressure, 1.0},
    {"mbar", UnitKind::pressure, 1.0},
    {"Pa", UnitKind::pressure, 0.01},
    {"kPa", UnitKind::pressure, 10.0},
    {"bar", UnitKind::pressure, 1000.0},
    {"mmHg", UnitKind::pressure, 1.33322387415},
    {"inHg", UnitKind::pressure, 33.86388640341},
    {"s", UnitKind::time, 1.0},
    {"ms", UnitKind::time, 1e-3},
    {"us", UnitKind::time, 1e-6},
    {"min", UnitKind::time, 60.0},
    {"h", UnitKind::time, 3600.0},
}};

}  // namespace

std::optional<Unit> unit_named(std::string_view name) {
  const auto* const found =
      std::ranges::find_if(kUnits, [&](const Unit& unit) { return lower(unit.name) == lower(name); });
  return found == kUnits.end() ? std::nullopt : std::optional(*found);
}

std::string unit_names() {
  std::string names;
  for (const Unit& unit : kUnits)
    if (static_cast<unsigned char>(unit.name.front()) < 0x80) names.append(names.empty() ? "" : " ").append(unit.name);
  return names;
}

namespace {

/// "1200,5" of "1.200,5": without the sign between thousands; empty where none is.
std::string without_thousands(std::string_view text) {
  constexpr std::size_t kGroup = 3;
  const std::size_t decimal = text.find_last_of(".,");
  const std::size_t first = text.find_first_of(".,' ");
  if (decimal == text.npos || first == decimal || text[first] == text[decimal]) return {};
  const std::size_t start = text.starts_with('-') || text.starts_with('+') ? 1 : 0;
  if (first <= start || first > start + kGroup) return {};
  std::string plain(text.substr(0, first));
  for (std::size_t at = first; at != decimal; at += kGroup + 1) {
    const std::string_view group = text.substr(at + 1, kGroup);
    if (at > decimal || text[at] != text[first] || group.size() < kGroup ||
        group.find_first_not_of("0123456789") != group.npos)
      return {};
    plain += group;
  }
  return plain.append(text.substr(decimal));
}

}  // namespace

std::optional<double> number_or_comma(std::string_view text) {
  if (const auto plain = number_in(text)) return plain;
  if (const std::string plain = without_thousands(text); !plain.empty()) return number_or_comma(plain);
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos || text.find(',', comma + 1) != std::string_view::npos ||
      text.find('.') != std::string_view::npos)
    return std::nullopt;
  std::string with_point(text);
  with_point[comma] = '.';
  return number_in(with_point);
}

}  // namespace ecs::laser
