#include "modules/report/markup.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::app {
namespace {

constexpr std::string_view kMinus = "\u2212";
constexpr std::string_view kThinBlank = "\u202f";
constexpr std::size_t kShort = 22;  ///< rows of a table that is not cut

bool is_word(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); }

std::string class_attribute(std::string_view words) {
  return words.empty() ? std::string() : fmt::format("class=\"{}\"", words);
}

std::string with_minus(std::string digits) {
  if (!digits.starts_with('-')) return digits;
  if (digits.find_first_of("123456789") == std::string::npos) return digits.substr(1);
  return std::string(kMinus) + digits.substr(1);
}

}  // namespace

Markup Markup::literal(std::string html) { return Markup(std::move(html)); }

Markup text(std::string_view plain) {
  static const std::map<char, std::string_view> kNamed{
      {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
  std::string html;
  for (const char c : shown(plain)) {
    const auto named = kNamed.find(c);
    html += named == kNamed.end() ? std::string_view(&c, 1) : named->second;
  }
  return Markup::literal(std::move(html));
}

Markup element(std::string_view tag, const Markup& inside, std::string_view attributes) {
  return Markup::literal(
      fmt::format("<{}{}{}>{}</{}>", tag, attributes.empty() ? "" : " ", attributes, inside.html(), tag));
}

Markup element(std::string_view tag, std::string_view inside, std::string_view attributes) {
  return element(tag, text(inside), attributes);
}

std::string fresh_id(std::string_view name, std::vector<std::string>& used) {
  std::string base;
  for (const char c : name) base += is_word(c) ? c : '-';
  if (base.empty() || base.front() == '-' || (base.front() >= '0' && base.front() <= '9')) base = "m" + base;
  std::string id = base;
  for (int n = 2; std::find(used.begin(), used.end(), id) != used.end(); ++n) id = fmt::format("{}-{}", base, n);
  used.push_back(id);
  return id;
}

std::string css_string(std::string_view plain) {
  std::string out;
  for (const char c : shown(plain)) {
    if (is_word(c) || c == ' ' || static_cast<unsigned char>(c) >= 0x80)
      out += c;
    else
      out += fmt::format("\\{:06x} ", static_cast<unsigned>(static_cast<unsigned char>(c)));
  }
  return out;
}

std::string number_text(double value, int decimals) {
  if (!std::isfinite(value)) return "\u2013";
  return with_minus(fmt::format("{:.{}f}", value, decimals));
}

std::string quantity_text(double value, int decimals, std::string_view unit) {
  return fmt::format("{}{}{}", number_text(value, decimals), kThinBlank, unit_text(unit));
}

std::string plain_number(double value) {
  if (!std::isfinite(value)) return "\u2013";
  std::string digits = fmt::format("{:.3f}", value);
  digits.erase(digits.find_last_not_of('0') + 1);
  if (digits.ends_with('.')) digits.pop_back();
  return with_minus(std::move(digits));
}

int decimals_for(double value) {
  const double size = std::abs(value);
  if (size >= 2.0) return 1;
  if (size >= 0.2) return 2;
  return size > 0.0 ? 3 : 1;
}

std::string unit_text(std::string_view unit) {
  std::string out;
  for (std::size_t at = 0; at < unit.size();) {
    const auto joins = [](char c) { return is_word(c) || c == '_'; };
    const bool begins = at == 0 || !joins(unit[at - 1]);
    const auto here = [&](std::string_view word) {
      return begins && unit.substr(at).starts_with(word) &&
             (at + word.size() == unit.size() || !joins(unit[at + word.size()]));
    };
    if (here("um") || here("us")) {
      out += "µ";
      out += unit[at + 1];
      at += 2;
    } else if (here("m2") || here("m3")) {
      out += unit[at + 1] == '2' ? "m²" : "m³";
      at += 2;
    } else if (here("degC")) {
      out += "°C";
      at += 4;
    } else {
      out += unit[at++];
    }
  }
  return out;
}

std::string counted(std::size_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::vector<TableColumn> columns(std::string_view titles) {
  std::vector<TableColumn> all;
  for (const std::string_view title : split(titles, '|')) {
    const bool number = title.starts_with('>');
    all.push_back({std::string(title.substr(number ? 1 : 0)), number});
  }
  return all;
}

TableMarkup::TableMarkup(std::vector<TableColumn> columns, std::string_view style)
    : columns_(std::move(columns)), style_(style) {}

void TableMarkup::row(const std::vector<Markup>& cells, std::string_view style) {
  Markup line;
  for (std::size_t i = 0; i < cells.size(); ++i)
    line += element("td", cells[i], class_attribute(i < columns_.size() && columns_[i].number ? "n" : ""));
  ++count_;
  rows_ += element("tr", line, class_attribute(style)) + Markup::literal("\n");
}

Markup TableMarkup::markup() const {
  Markup head;
  for (const TableColumn& column : columns_)
    head += element("th", column.title, column.number ? "class=\"n\" scope=\"col\"" : "scope=\"col\"");
  return element("table", element("thead", element("tr", head)) + Markup::literal("\n") + element("tbody", rows_),
                 class_attribute(count_ > kShort  ? style_
                                 : style_.empty() ? "whole"
                                                  : style_ + " whole")) +
         Markup::literal("\n");
}

}  // namespace ecs::app
