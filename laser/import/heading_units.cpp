#include "laser/import/heading_units.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "base/text.hpp"

namespace ecs::laser {
namespace {

/// How headings spell units beside their names.
constexpr std::array<std::pair<std::string_view, std::string_view>, 29> kSpellings{{
    {"zoll", "in"},
    {"inches", "in"},
    {"pouce", "in"},
    {"pouces", "in"},
    {"micron", "um"},
    {"microns", "um"},
    {"mikrometer", "um"},
    {"micrometer", "um"},
    {"micrometre", "um"},
    {"millimeter", "mm"},
    {"millimetre", "mm"},
    {"meter", "m"},
    {"metre", "m"},
    {"grad", "deg"},
    {"degree", "deg"},
    {"degrees", "deg"},
    {"\xC2\xB0", "deg"},
    {"\xC2\xB0"
     "c",
     "degC"},
    {"deg c", "degC"},
    {"celsius", "degC"},
    {"\xE2\x84\x83", "degC"},
    {"\xC2\xB0"
     "f",
     "degF"},
    {"fahrenheit", "degF"},
    {"sek", "s"},
    {"sec", "s"},
    {"seconds", "s"},
    {"winkelsekunden", "arcsec"},
    {"c", "degC"},
    {"f", "degF"},
}};

/// Written out, they mean nothing else at the end of a heading.
constexpr std::array<std::string_view, 21> kPlain{"mm",     "um",   "nm",   "cm",   "inch", "mil",  "arcsec",
                                                  "arcmin", "mrad", "urad", "um/m", "mm/m", "degC", "degF",
                                                  "deg",    "hPa",  "mbar", "kPa",  "mmHg", "inHg", "in"};

/// "µ" and "μ" as u.
std::string with_plain_micro(std::string text) {
  for (const std::string_view micro : {"\xC2\xB5", "\xCE\xBC"})
    for (std::size_t at = text.find(micro); at != std::string::npos; at = text.find(micro)) text.replace(at, 2, "u");
  return text;
}

std::optional<Unit> spelt(std::string_view word) {
  const std::string plain = with_plain_micro(lower(trimmed(word)));
  const auto* const found =
      std::find_if(kSpellings.begin(), kSpellings.end(), [&](const auto& spelling) { return spelling.first == plain; });
  return unit_named(found == kSpellings.end() ? std::string_view(plain) : found->second);
}

/// A temperature of one letter needs a heading of temperature: (F) is forward, (C) an axis.
bool is_doubtful(std::string_view word, const Unit& unit, std::string_view heading) {
  if (unit.kind != UnitKind::temperature || trimmed(word).size() != 1) return false;
  return lower(heading).find("temp") == std::string::npos;
}

std::optional<Unit> in_brackets(std::string_view heading) {
  for (const auto& [open, close] : {std::pair{'[', ']'}, {'(', ')'}, {'{', '}'}}) {
    const std::size_t end = heading.rfind(close);
    const std::size_t begin = end == std::string_view::npos ? end : heading.rfind(open, end);
    if (begin == std::string_view::npos) continue;
    std::string_view word = trimmed(heading.substr(begin + 1, end - begin - 1));
    if (lower(word).starts_with("in ")) word.remove_prefix(3);
    if (const auto unit = spelt(word); unit && !is_doubtful(word, *unit, heading)) return unit;
  }
  return std::nullopt;
}

/// At the end, behind a blank, a comma or a slash.
std::optional<Unit> at_end(std::string_view heading) {
  const std::string_view last = heading.substr(heading.find_last_of(" ,:\t") + 1);
  for (const std::string_view word : {last, last.substr(last.rfind('/') + 1)}) {
    if (word.size() == heading.size()) continue;  // the whole heading: a name
    const auto unit = spelt(word);
    const bool is_word = lower(trimmed(word)) == "in";  // "lead in"
    if (unit && !is_word && std::find(kPlain.begin(), kPlain.end(), unit->name) != kPlain.end()) return unit;
  }
  return std::nullopt;
}

std::optional<Unit> behind_underscore(std::string_view heading) {
  constexpr std::string_view kPer = "_per_";  // "error_um_per_m"
  if (const std::size_t per = lower(heading).rfind(kPer); per != std::string::npos) {
    const std::string_view above = heading.substr(0, per);
    return spelt(std::string(above.substr(above.rfind('_') + 1)) + "/" +
                 std::string(heading.substr(per + kPer.size())));
  }
  const std::size_t at = heading.rfind('_');
  if (at == std::string_view::npos || at == 0) return std::nullopt;
  const std::string_view word = heading.substr(at + 1);
  const std::string plain = lower(word);
  if (plain == "min" || plain == "h" || plain == "f" || plain == "k") return std::nullopt;  // least, height, forward
  return spelt(word);
}

}  // namespace

std::optional<Unit> unit_in_heading(std::string_view heading) {
  const std::string_view text = trimmed(heading);
  if (const auto unit = in_brackets(text)) return unit;
  if (const auto unit = behind_underscore(text)) return unit;
  return at_end(text);
}

}  // namespace ecs::laser
