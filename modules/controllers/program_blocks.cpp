#include "modules/controllers/program_blocks.hpp"

#include <cctype>
#include <initializer_list>
#include <utility>

#include <fmt/format.h>

#include "modules/controllers/curve.hpp"

namespace ecs::controllers {
namespace {

constexpr double kSameWord = 1e-9;  ///< words that differ by less are the same number
constexpr int kFirstOffset = 54;    ///< G54 acts where the program names none

bool is_one_of(int code, std::initializer_list<int> codes) {
  return std::find(codes.begin(), codes.end(), code) != codes.end();
}

/// Why a G code is refused; empty: it is known.
std::string_view refusal_of(int code) {
  if (is_one_of(code, {0,   10,  20,  30,  40,  80,  90,  150, 170, 180, 190, 200, 210, 280, 300,
                       400, 430, 440, 490, 500, 530, 540, 550, 560, 570, 580, 590, 610, 611, 620,
                       640, 690, 700, 710, 800, 900, 910, 911, 930, 940, 950, 960, 970, 980, 990}) ||
      is_cycle(code))
    return {};
  if (is_one_of(code, {410, 411, 420, 421}))
    return "tool radius compensation cannot be corrected, because the control computes the path; output the path of "
           "the tool centre";
  if (is_one_of(code, {100, 520, 920, 921, 922, 923}))
    return "it changes the zero point of the program; use G54 to G59";
  if (is_one_of(code, {160, 510, 511, 680, 681}))
    return "polar coordinates, rotation, scaling and mirroring cannot be corrected; output plain coordinates";
  if (is_one_of(code, {320, 330, 331, 332, 760})) return "threads cannot be corrected: their pieces would not join";
  if (is_one_of(code, {650, 660, 661, 670}))
    return "macros cannot be corrected; write the moves one by one (CAM systems have such an option)";
  if (is_one_of(code, {870, 880})) return "this cycle cannot be corrected; write its moves one by one";
  if (code == 901) return "absolute centres of arcs are not supported; use centres counted from the start (G91.1)";
  return "not known here: positions behind it would be uncertain";
}

}  // namespace

bool is_cycle(int code) { return is_one_of(code, {730, 740, 810, 820, 830, 840, 850, 860, 890}); }
bool is_before_motion(const ProgramWord& m) { return is_one_of(code_of(m), {30, 40, 60, 70, 80}); }
bool is_behind_motion(const ProgramWord& m) { return is_one_of(code_of(m), {0, 10, 20, 50, 90, 300, 600}); }

// --- what the words of a block ask for

BlockReader::BlockReader(const PartProgram& program, const ProgramSettings& settings)
    : settings_(settings), findings_(program.file) {
  if (const auto at = settings.work_offset_mm.find(kFirstOffset); at != settings.work_offset_mm.end())
    modal_.zero_point_mm = at->second;
}

std::optional<BlockOfWords> BlockReader::read(const ProgramLine& line) {
  BlockOfWords block = words_of(line);
  if (!check(line, block)) return std::nullopt;
  if (block.has(40)) return block;
  if (!remember(line, block)) return std::nullopt;
  for (const ProgramWord* m : block.m)
    if (is_one_of(code_of(*m), {20, 300})) ended_ = line.number;
  return block;
}

void BlockReader::complain(const ProgramLine& line, const ProgramWord& word, std::string_view message) {
  findings_.add(line.number, static_cast<int>(word.at) + 1, "{}: {}", line.text_of(word), message);
}

BlockOfWords BlockReader::words_of(const ProgramLine& line) {
  BlockOfWords block;
  const auto set = [&](const ProgramWord*& place, const ProgramWord& word) {
    if (place) complain(line, word, fmt::format("a second {} in one block", word.letter));
    place = &word;
  };
  const bool dwell = std::any_of(line.words.begin(), line.words.end(),
                                 [](const ProgramWord& w) { return w.letter == 'G' && code_of(w) == 40; });
  for (const ProgramWord& word : line.words) {
    switch (word.letter) {
      case 'G':
        block.g.push_back(&word);
        if (code_of(word) <= 30 || is_cycle(code_of(word))) set(block.motion, word);
        break;
      case 'M':
        block.m.push_back(&word);
        break;
      case 'X':
      case 'Y':
      case 'Z':
        if (!dwell) set(block.axis[static_cast<std::size_t>(word.letter - 'X')], word);
        break;
      case 'I':
      case 'J':
      case 'K':
        if (word.letter == 'K' && is_cycle(block.motion ? code_of(*block.motion) : modal_.motion))
          set(block.repeats, word);
        else
          set(block.centre[static_cast<std::size_t>(word.letter - 'I')], word);
        break;
      case 'R':
        set(block.radius, word);
        break;
      case 'F':
        set(block.feed, word);
        break;
      case 'H':
        block.tool = &word;
        break;
      case 'L':
        block.repeats = &word;
        break;
      case 'P':
        block.turns = &word;
        break;
      case 'A':
      case 'B':
      case 'C':
      case 'U':
      case 'V':
      case 'W':
        if (!dwell) complain(line, word, "rotary and secondary axes cannot be corrected; the map has X, Y and Z");
        break;
      default:
        break;
    }
    if (!word.has_point && word.value != 0.0 &&
        std::string_view("XYZIJKR").find(word.letter) != std::string_view::npos && whole_numbers_in_ == 0 && !dwell)
      whole_numbers_in_ = line.number;
  }
  return block;
}

bool BlockReader::check(const ProgramLine& line, const BlockOfWords& block) {
  bool good = true;
  const auto refuse = [&](const ProgramWord& word, std::string_view why) {
    complain(line, word, why);
    good = false;
  };
  for (const ProgramWord* g : block.g)
    if (const std::string_view why = refusal_of(code_of(*g)); !why.empty()) refuse(*g, why);
  for (const ProgramWord* m : block.m)
    if (is_one_of(code_of(*m), {960, 970, 980, 990, 1980}))
      refuse(*m, "subprograms cannot be corrected; write their moves one by one (CAM systems have such an option)");
  for (const Axis axis : kAllAxes)
    if (const ProgramWord* word = block.axis[index_of(axis)]; word && !settings_.present[index_of(axis)])
      refuse(*word, fmt::format("the machine of the parameters has no axis {}", letter_of(axis)));
  if (block.has(500) && block.names_axis())
    refuse(*block.g.front(), "G50 with coordinates changes the zero point or the scale; use G54 to G59");
  if (ended_ && (block.names_axis() || !block.g.empty()))
    refuse(line.words.front(), fmt::format("expected nothing behind the end of the program in line {}", ended_));
  if (line.optional && (block.names_axis() || block.has_centre() || !block.g.empty()))
    refuse(line.words.front(),
           "an optional block (/) with a motion: it is not known whether it is executed; remove "
           "the \"/\" or the block");
  return good;
}

bool BlockReader::remember(const ProgramLine& line, const BlockOfWords& block) {
  for (const ProgramWord* g : block.g) {
    const int code = code_of(*g);
    if (is_one_of(code, {170, 180, 190})) modal_.plane = code / 10;
    if (is_one_of(code, {200, 700})) modal_.unit_mm = 25.4;
    if (is_one_of(code, {210, 710})) modal_.unit_mm = 1.0;
    if (is_one_of(code, {900, 910})) modal_.incremental = code == 910;
    if (is_one_of(code, {930, 940, 950})) modal_.inverse_time = code == 930;
    if (is_one_of(code, {980, 990})) modal_.to_initial = code == 980;
    if (code == 800) modal_.motion = -1;
    if (code == 490) modal_.tool_mm = 0.0;
    if (code >= 540 && code <= 590 && !use_offset(line, *g)) return false;
    if ((code == 430 || code == 440) && !use_tool(line, *g, block)) return false;
  }
  if (block.motion) modal_.motion = code_of(*block.motion);
  return true;
}

bool BlockReader::use_offset(const ProgramLine& line, const ProgramWord& word) {
  const auto at = settings_.work_offset_mm.find(code_of(word) / 10);
  if (at == settings_.work_offset_mm.end()) {
    complain(line, word,
             fmt::format("its zero point is not given; give --work-offset G{}:x=..,y=..,z=.. in machine "
                         "coordinates",
                         code_of(word) / 10));
    return false;
  }
  modal_.zero_point_mm = at->second;
  return true;
}

bool BlockReader::use_tool(const ProgramLine& line, const ProgramWord& word, const BlockOfWords& block) {
  const int number = block.tool ? static_cast<int>(std::lround(block.tool->value)) : -1;
  const auto at = settings_.tool_length_mm.find(number);
  if (number != 0 && at == settings_.tool_length_mm.end()) {
    complain(line, word,
             number < 0 ? std::string("expected the number H of a tool length in the same block")
                        : fmt::format("the length of tool H{0} is not given; give --tool-length {0}=LENGTH in mm, 0 if "
                                      "the work offset contains it",
                                      number));
    return false;
  }
  modal_.tool_mm = number == 0 ? 0.0 : (code_of(word) == 430 ? 1.0 : -1.0) * at->second;
  return true;
}

// --- how it is written

/// One line with words replaced, removed and added.
class LineEdit {
 public:
  /// @param spaced  blanks go between words
  LineEdit(const ProgramLine& line, bool spaced) : line_(line), spaced_(spaced) {}
  [[nodiscard]] bool spaced() const { return spaced_; }
  [[nodiscard]] bool changed() const { return !edits_.empty(); }
  void replace(const ProgramWord& word, std::string text) {
    if (text != line_.text_of(word)) edits_.push_back({word.at, word.size, std::move(text)});
  }
  /// With the blanks behind it.
  void remove(const ProgramWord& word) {
    std::size_t end = word.at + word.size;
    while (end < line_.text.size() && line_.text[end] == ' ') ++end;
    edits_.push_back({word.at, end - word.at, ""});
  }
  void add_behind(const ProgramWord& word, const std::string& text) {
    edits_.push_back({word.at + word.size, 0, (spaced_ ? " " : "") + text});
  }
  void add_before(const ProgramWord& word, const std::string& text) {
    edits_.push_back({word.at, 0, text + (spaced_ ? " " : "")});
  }
  [[nodiscard]] std::string text() {
    std::stable_sort(edits_.begin(), edits_.end(), [](const Edit& a, const Edit& b) { return a.at < b.at; });
    std::string made;
    std::size_t done = 0;
    for (const Edit& edit : edits_) {
      const std::size_t at = std::max(edit.at, done);
      made += line_.text.substr(done, at - done) + edit.text;
      done = std::max(done, edit.at + edit.size);
    }
    made += line_.text.substr(done);
    if (!line_.text.ends_with(' ')) made.erase(made.find_last_not_of(' ') + 1);
    return made;
  }

 private:
  struct Edit {
    std::size_t at, size;
    std::string text;
  };
  const ProgramLine& line_;
  std::vector<Edit> edits_;
  bool spaced_;
};

namespace {

/// Words of axes that are not named go behind those that are, else behind the last G word, else in front.
void add_word(const ProgramLine& line, const BlockOfWords& block, LineEdit& edit, const std::string& word) {
  const ProgramWord* behind = nullptr;
  for (const ProgramWord* one : block.axis)
    if (one && (!behind || one->at > behind->at)) behind = one;
  if (behind) return edit.add_behind(*behind, word);
  const auto centre = std::find_if(line.words.begin(), line.words.end(), [](const ProgramWord& one) {
    return std::string_view("IJKR").find(one.letter) != std::string_view::npos;
  });
  if (centre != line.words.end()) return edit.add_before(*centre, word);
  edit.add_behind(block.g.empty() ? line.words.back() : *block.g.back(), word);
}

/// G93: F is one over the time of the block.
std::string feed_word(const ProgramWord& feed, double share) {
  return fmt::format("F{}", fixed_text(feed.value / share, std::max(feed.decimals, 3)));
}

/// What acts at the end of the whole move: a stop, an exact stop.
void move_to_last_piece(const ProgramLine& line, const BlockOfWords& block, LineEdit& edit, std::string& last) {
  const auto move = [&](const ProgramWord& word, bool in_front) {
    const std::string text(line.text_of(word));
    const std::string blank = edit.spaced() ? " " : "";
    last = in_front ? text + blank + last : last + blank + text;
    edit.remove(word);
  };
  for (const ProgramWord* m : block.m)
    if (is_behind_motion(*m)) move(*m, false);
  for (const ProgramWord* g : block.g)
    if (code_of(*g) == 90) move(*g, true);
}

}  // namespace

void BlockWriter::keep(const ProgramLine& line) { made_.text += line.text + line.end; }

void BlockWriter::keep(const ProgramLine& line, const BlockOfWords& block) {
  if (block.motion) written_motion_ = modal_.motion;
  keep(line);
}

void BlockWriter::keep_in_motion(const ProgramLine& line, const BlockOfWords& block) {
  LineEdit edit(line, program_.spaced);
  write_motion_word(line, block, edit, modal_.motion);
  made_.text += edit.text() + line.end;
}

std::vector<Vector3> BlockWriter::write(const ProgramLine& line, const BlockOfWords& block,
                                        const std::vector<Vector3>& aims_mm, const std::vector<double>& shares,
                                        int motion) {
  LineEdit edit(line, program_.spaced);
  write_motion_word(line, block, edit, motion);
  if (motion != modal_.motion) {
    for (const ProgramWord* one : block.centre)
      if (one) edit.remove(*one);
    if (block.radius) edit.remove(*block.radius);
  }
  for (const Axis axis : kAllAxes) {
    const std::size_t a = index_of(axis);
    if (block.axis[a] || actual_[a]) send(line, block, edit, axis, aims_mm.front()[a], actual_[a]);
  }
  std::vector<Vector3> reached{place_mm()};
  std::vector<std::string> pieces;
  for (std::size_t k = 1; k < aims_mm.size(); ++k) {
    pieces.push_back(piece_to(line, aims_mm[k]));
    reached.push_back(place_mm());
    if (pieces.back().empty())
      pieces.pop_back();
    else if (modal_.inverse_time && block.feed)
      pieces.back() += (edit.spaced() ? " " : "") + feed_word(*block.feed, shares[k]);
  }
  if (!pieces.empty()) {
    if (modal_.inverse_time && block.feed) edit.replace(*block.feed, feed_word(*block.feed, shares.front()));
    move_to_last_piece(line, block, edit, pieces.back());
  }
  if (edit.changed()) ++made_.corrected;
  const std::string end = line.end.empty() && !pieces.empty() ? "\n" : line.end;
  made_.text += edit.text() + end;
  for (std::size_t k = 0; k < pieces.size(); ++k) made_.text += pieces[k] + (k + 1 < pieces.size() ? end : line.end);
  made_.blocks_added += pieces.size();
  return reached;
}

void BlockWriter::write_hole(const ProgramLine& line, const BlockOfWords& block, const Vector3& aim_mm,
                             std::optional<double>& bottom_mm) {
  LineEdit edit(line, program_.spaced);
  written_motion_ = modal_.motion;
  for (const Axis axis : kAllAxes)
    send(line, block, edit, axis, aim_mm[index_of(axis)], axis == Axis::Z ? bottom_mm : actual_[index_of(axis)]);
  if (edit.changed()) ++made_.corrected;
  made_.text += edit.text() + line.end;
}

std::optional<std::string> BlockWriter::coordinate(const ProgramLine& line, Axis axis, double aim_mm,
                                                   const ProgramWord* original, std::optional<double>& actual_mm) {
  const int digits = std::max(settings_.decimals + (modal_.unit_mm == 1.0 ? 0 : 1), original ? original->decimals : 0);
  const double grid_mm = std::pow(10.0, -digits) * modal_.unit_mm;
  if (!original && actual_mm && std::abs(aim_mm - *actual_mm) <= 0.5001 * grid_mm) return std::nullopt;
  const double from_mm = modal_.incremental ? actual_mm.value_or(0.0) : modal_.frame_mm(index_of(axis));
  const double scale = std::pow(10.0, digits);
  const double value = std::round((aim_mm - from_mm) / modal_.unit_mm * scale) / scale;
  const bool same = original && std::abs(value - original->value) < kSameWord;
  actual_mm = without_noise(from_mm + (same ? original->value : value) * modal_.unit_mm);
  made_.rounding_um[index_of(axis)] = std::max(made_.rounding_um[index_of(axis)], std::abs(*actual_mm - aim_mm) * 1e3);
  if (same) return std::string(line.text_of(*original));
  const bool small = !line.words.empty() && std::islower(static_cast<unsigned char>(line.text[line.words.back().at]));
  return fmt::format("{}{}", small ? small_letter_of(axis) : letter_of(axis), fixed_text(value, digits));
}

void BlockWriter::send(const ProgramLine& line, const BlockOfWords& block, LineEdit& edit, Axis axis, double aim_mm,
                       std::optional<double>& actual_mm) {
  const ProgramWord* original = block.axis[index_of(axis)];
  const auto word = coordinate(line, axis, aim_mm, original, actual_mm);
  if (word && original)
    edit.replace(*original, *word);
  else if (word)
    add_word(line, block, edit, *word);
}

void BlockWriter::write_motion_word(const ProgramLine& line, const BlockOfWords& block, LineEdit& edit, int motion) {
  if (block.motion && code_of(*block.motion) != motion) {
    std::string text(line.text_of(*block.motion));
    text[text.find_first_of("23")] = '1';  // an arc as lines
    edit.replace(*block.motion, text);
  } else if (!block.motion && written_motion_ != motion && motion >= 0) {
    const auto moves = [](const ProgramWord& word) {
      return std::string_view("XYZIJKR").find(word.letter) != std::string_view::npos;
    };
    edit.add_before(*std::find_if(line.words.begin(), line.words.end(), moves), fmt::format("G{}", motion / 10));
  }
  written_motion_ = motion;
}

std::string BlockWriter::piece_to(const ProgramLine& line, const Vector3& aim_mm) {
  std::string words;
  for (const Axis axis : kAllAxes)
    if (actual_[index_of(axis)])
      if (const auto word = coordinate(line, axis, aim_mm[index_of(axis)], nullptr, actual_[index_of(axis)]))
        words += (program_.spaced && !words.empty() ? " " : "") + *word;
  return words;
}

}  // namespace ecs::controllers
