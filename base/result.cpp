#include "base/result.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>

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
  std::vector<Problem> once;
  for (Problem& one : problems)
    if (std::ranges::find(once, one) == once.end()) once.push_back(std::move(one));
  Problem first = std::move(once.front());
  first.also.insert(first.also.end(), std::make_move_iterator(once.begin() + 1), std::make_move_iterator(once.end()));
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
