// Words of the trade and of this unit that a screen uses, explained: `?` lists those that the picture shows.
#pragma once

#include <string>
#include <vector>

namespace ecs::app {

struct ExplainedWord {
  std::string word;
  std::string meaning;
};

/// Those that occur in a text, whatever their case, in the order of the alphabet.
[[nodiscard]] std::vector<ExplainedWord> words_explained_in(const std::string& text);

}  // namespace ecs::app
