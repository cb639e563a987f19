#include "base/result.hpp"

#include <cassert>
#include <iterator>

#include <fmt/format.h>

namespace ecs {

Problem folded(std::vector<Problem> problems) {
  assert(!problems.empty());
  Problem first = std::move(problems.front());
  first.also.insert(first.also.end(), std::make_move_iterator(problems.begin() + 1),
                    std::make_move_iterator(problems.end()));
  return first;
}

std::string to_text(const Problem& problem) {
  std::string text;
  if (!problem.file.empty()) {
    text = problem.file;
    if (problem.line > 0) text += fmt::format(":{}", problem.line);
    if (problem.line > 0 && problem.column > 0) text += fmt::format(":{}", problem.column);
    text += ": ";
  }
  text += problem.message;
  for (const Problem& other : problem.also) {
    text += '\n';
    text += to_text(other);
  }
  return text;
}

}  // namespace ecs
