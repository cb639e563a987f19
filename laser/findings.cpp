#include "laser/findings.hpp"

namespace ecs::laser {

void Findings::add(int line, int column, std::string message) {
  if (++count_ <= kMostShown)
    shown_.push_back(Problem{ProblemKind::bad_input, std::move(message), file_, line, column, {}});
}

Problem Findings::as_problem() const {
  std::vector<Problem> all = shown_;
  if (count_ > kMostShown)
    all.push_back(Problem{ProblemKind::bad_input,
                          fmt::format("and {} more fault{}", count_ - kMostShown, count_ - kMostShown == 1 ? "" : "s"),
                          file_,
                          0,
                          0,
                          {}});
  return folded(std::move(all));
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  if (text.empty()) return "nothing";
  std::string shown;
  for (const char c : text.substr(0, kLongest)) {
    const auto byte = static_cast<unsigned char>(c);
    shown += byte < 0x20 || byte == 0x7f ? '?' : c;
  }
  if (text.size() > kLongest) {  // cut between characters, not inside one
    while (!shown.empty() && (static_cast<unsigned char>(text[shown.size()]) & 0xC0u) == 0x80u) shown.pop_back();
    shown += "...";
  }
  return "\"" + shown + "\"";
}

}  // namespace ecs::laser
