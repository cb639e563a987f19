#include "base/result.hpp"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

namespace ecs {

namespace {
constexpr std::size_t kMostFolded = 200;  ///< more than anyone reads
}

Problem folded(std::vector<Problem> problems) {
  assert(!problems.empty());
  if (const std::size_t found = problems.size(); found > kMostFolded) {
    problems.resize(kMostFolded);
    Problem rest = problems.front();
    rest.message = fmt::format("{} more problems of this file are not shown", found - kMostFolded);
    rest.line = rest.column = 0;
    rest.also.clear();
    problems.push_back(std::move(rest));
  }
  Problem first = std::move(problems.front());
  for (auto one = problems.begin() + 1; one != problems.end(); ++one)
    if (*one != first && std::ranges::find(first.also, *one) == first.also.end()) first.also.push_back(std::move(*one));
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
