#include "app/ui/words.hpp"

#include <cctype>

#include "base/text.hpp"

namespace ecs::app {
namespace {

/// A word with its other forms in `forms`, parted by '|'.
struct GlossaryRow {
  const char* forms;
  const char* meaning;
};

constexpr GlossaryRow kGlossary[] = {
    {"alias", "another period that the same targets cannot tell from the one found"},
    {"approach", "the direction in which the axis last moved: forward (up) or reverse (down)"},
    {"armed|arm code", "the unit takes writes and commands of this host; its code, which it shows, is needed for that"},
    {"commit", "the step that makes a map sent completely the active one; before it the old map stays"},
    {"compensation mode|compensating|compensation",
     "the unit adds the map's values to the feedback, in every period of its loop; it takes no writes"},
    {"datum|datuming", "finding the machine's zero: switch, then marker, while the control references the axis"},
    {"deadband", "travel in the new direction after which the approach counts as changed"},
    {"dead path", "laser path that is there before the reading is set to zero; its air is not corrected"},
    {"diagnosis|diagnose", "the search for what the model lacks, with proof"},
    {"held out|held-out",
     "checked on readings that were kept out of the fit: an effect that is not real does not help there"},
    {"integration mode|integration|integrating",
     "the unit is set up: it takes parameters, maps and commands, and compensates nothing; relays are open"},
    {"lack of fit", "whether the model misses more than the scatter of repeated readings explains"},
    {"marker", "the index pulse of the transducer, once a revolution or at one place; with the switch it is the datum"},
    {"parked", "where the other axes stood while one was measured: angles act by the distance to that place"},
    {"pitch", "travel per turn of a screw, or distance of the lines of a scale: errors repeat with it"},
    {"referenced", "the axis has found its datum since power-up: its positions are true machine coordinates"},
    {"relay", "connects the unit's output with the control's feedback; open: the unit cannot act on the machine"},
    {"residual", "what the model leaves of a reading"},
    {"reversal error|reversal", "difference of the two approaches at the same target; backlash is one cause"},
    {"rms", "root of the mean square: the usual size of what is left"},
    {"rival|rivals", "an effect that these data cannot tell from the one named"},
    {"scope", "what the unit compensates with: linear (each axis by itself), planar or volumetric"},
    {"sigma", "standard deviation; 1 sigma is the usual scatter of one reading"},
    {"slope", "the part of a curve that is proportional to the position, in um/m"},
    {"squareness", "how far two axes are from 90 degrees, one number for a pair of axes, in um/m"},
    {"staging", "the place in the unit where a new map is written beside the active one"},
    {"tie|tied", "effects that do the same on these data; a further measurement decides"},
};

bool is_letter_of_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

bool occurs(const std::string& text, std::string_view word) {
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !is_letter_of_word(text[at - 1])) && (end == text.size() || !is_letter_of_word(text[end])))
      return true;
  }
  return false;
}

}  // namespace

std::vector<ExplainedWord> words_explained_in(const std::string& text) {
  const std::string seen = lower(text);
  std::vector<ExplainedWord> found;
  for (const GlossaryRow& row : kGlossary) {
    const auto forms = split(row.forms, '|');
    for (const std::string_view form : forms)
      if (occurs(seen, form)) {
        found.push_back({std::string(forms.front()), row.meaning});
        break;
      }
  }
  return found;
}

}  // namespace ecs::app
