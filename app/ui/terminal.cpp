#include "app/ui/terminal.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <clocale>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <cwchar>
#include <string>

#include <langinfo.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#define NCURSES_WIDECHAR 1
#include <curses.h>

#include "base/sealed.hpp"

namespace ecs::app {
namespace {

/// Mouse off, main screen, cursor on, plain letters: works on terminals that know it, does nothing on others.
constexpr char kPutRight[] = "\033[?1000l\033[?1006l\033[?1049l\033[?25h\033[0m";

extern "C" void on_crash(int signal) {
  const ssize_t written = ::write(STDOUT_FILENO, kPutRight, sizeof kPutRight - 1);
  (void)written;
  ::reset_shell_mode();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void catch_crashes() {
  struct sigaction action {};
  action.sa_handler = on_crash;
  for (const int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL}) ::sigaction(signal, &action, nullptr);
}

struct Look {
  short foreground = -1;  ///< of eight colours; −1: the terminal's own
  attr_t with_colour = A_NORMAL;
  attr_t without = A_NORMAL;
};

Look look_of(Tone tone) {
  switch (tone) {
    case Tone::faint:
      return {COLOR_CYAN, A_NORMAL, A_NORMAL};
    case Tone::strong:
      return {-1, A_BOLD, A_BOLD};
    case Tone::selected:
      return {-1, A_REVERSE, A_REVERSE};
    case Tone::good:
      return {COLOR_GREEN, A_NORMAL, A_NORMAL};
    case Tone::warning:
      return {COLOR_YELLOW, A_BOLD, A_BOLD};
    case Tone::bad:
      return {COLOR_RED, A_BOLD, A_BOLD};
    case Tone::forward:
      return {COLOR_BLUE, A_BOLD, A_NORMAL};
    case Tone::reverse:
      return {COLOR_MAGENTA, A_NORMAL, A_NORMAL};
    case Tone::plain:
      break;
  }
  return {};
}

constexpr std::size_t kTones = 9;
constexpr char32_t kUnknown = U'\uFFFF';  ///< what a cell of the terminal shows is not known

/// Sequences that most terminals send, also where the terminal's description does not know them (a vt100 has no Page
/// Up, but whoever calls itself one often does).
void name_common_keys() {
  struct Sequence {
    const char* sent;
    int key;
  };
  constexpr Sequence kSequences[] = {
      {"\033[A", KEY_UP},     {"\033[B", KEY_DOWN},   {"\033[C", KEY_RIGHT}, {"\033[D", KEY_LEFT},
      {"\033OA", KEY_UP},     {"\033OB", KEY_DOWN},   {"\033OC", KEY_RIGHT}, {"\033OD", KEY_LEFT},
      {"\033[5~", KEY_PPAGE}, {"\033[6~", KEY_NPAGE}, {"\033[H", KEY_HOME},  {"\033[F", KEY_END},
      {"\033OH", KEY_HOME},   {"\033OF", KEY_END},    {"\033[1~", KEY_HOME}, {"\033[4~", KEY_END},
      {"\033[7~", KEY_HOME},  {"\033[8~", KEY_END},   {"\033[3~", KEY_DC},   {"\033[Z", KEY_BTAB},
      {"\033OP", KEY_F(1)},   {"\033[11~", KEY_F(1)}, {"\033[[A", KEY_F(1)}, {"\033OQ", KEY_F(2)},
      {"\033[12~", KEY_F(2)}, {"\033[[B", KEY_F(2)}};
  for (const Sequence& sequence : kSequences)
    if (::key_defined(sequence.sent) == 0) ::define_key(sequence.sent, sequence.key);
}

Key named(Key::Name name) { return {name, 0, 0, 0, 0}; }

Key key_of_code(wint_t code) {
  switch (code) {
    case KEY_UP:
      return named(Key::Name::up);
    case KEY_DOWN:
      return named(Key::Name::down);
    case KEY_LEFT:
      return named(Key::Name::left);
    case KEY_RIGHT:
      return named(Key::Name::right);
    case KEY_PPAGE:
      return named(Key::Name::page_up);
    case KEY_NPAGE:
      return named(Key::Name::page_down);
    case KEY_HOME:
      return named(Key::Name::home);
    case KEY_END:
      return named(Key::Name::end);
    case KEY_DC:
      return named(Key::Name::erase);
    case KEY_BACKSPACE:
      return named(Key::Name::backspace);
    case KEY_BTAB:
      return named(Key::Name::back_tab);
    case KEY_ENTER:
      return named(Key::Name::enter);
    case KEY_RESIZE:
      return named(Key::Name::resized);
    default:
      break;
  }
  if (code > KEY_F0 && code <= KEY_F(12)) return {Key::Name::function, 0, static_cast<int>(code) - KEY_F0, 0, 0};
  return {};
}

Key key_of_letter(wint_t code) {
  switch (code) {
    case L'\r':
    case L'\n':
      return named(Key::Name::enter);
    case 27:
      return named(Key::Name::escape);
    case L'\t':
      return named(Key::Name::tab);
    case 127:
    case 8:
      return named(Key::Name::backspace);
    default:
      break;
  }
  if (code < 32) return {Key::Name::control, static_cast<char32_t>(code + 'a' - 1), 0, 0, 0};
  return {Key::Name::letter, static_cast<char32_t>(code), 0, 0, 0};
}

Key pressed_at() {
  MEVENT event{};
  if (::getmouse(&event) != OK) return {};
  const auto at = [&event](Key::Name name) { return Key{name, 0, 0, event.y, event.x}; };
  if ((event.bstate & BUTTON4_PRESSED) != 0) return at(Key::Name::wheel_up);
  if ((event.bstate & BUTTON5_PRESSED) != 0) return at(Key::Name::wheel_down);
  if ((event.bstate & (BUTTON1_PRESSED | BUTTON1_CLICKED)) == 0) return {};
  return at(Key::Name::mouse);
}

/// Bytes a second that the line of the terminal carries; a pseudo-terminal says 38,400 baud.
double line_speed() {
  struct termios line {};
  if (::tcgetattr(STDOUT_FILENO, &line) != 0) return 3840.0;
  switch (::cfgetospeed(&line)) {
    case B1200:
      return 120.0;
    case B2400:
      return 240.0;
    case B4800:
      return 480.0;
    case B9600:
      return 960.0;
    case B19200:
      return 1920.0;
    default:
      return 3840.0;
  }
}

bool has_colour(const TerminalOptions& options) {
  const char* no = std::getenv("NO_COLOR");
  return options.colour && (no == nullptr || *no == '\0');
}

}  // namespace

struct Terminal::Screen {
  SCREEN* curses = nullptr;
  Glyphs glyphs = Glyphs::ascii;
  bool slow = false;
  Canvas sent{0, 0};  ///< what the terminal was given
  int next_row = 0;   ///< of the next piece
  double bytes_per_s = 3840.0;
  std::chrono::steady_clock::time_point busy_until{};
  std::array<attr_t, kTones> attributes{};

  Screen() = default;
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;
  ~Screen() {
    if (curses == nullptr) return;
    move(LINES - 1, 0);  // where there is no other screen to go back to, the shell goes on in a blank line
    clrtoeol();
    refresh();
    ::endwin();
    ::delscreen(curses);
  }

  [[nodiscard]] bool behind() const;
  void reckon(int cells);
  [[nodiscard]] int write_row(const Canvas& canvas, int r, int room);
  void choose_looks(bool colour) {
    const bool able = colour && ::has_colors();
    if (able) {
      ::start_color();
      ::use_default_colors();
    }
    for (std::size_t t = 0; t < kTones; ++t) {
      const Look look = look_of(static_cast<Tone>(t));
      attributes[t] = able ? look.with_colour : look.without;
      if (!able || look.foreground < 0) continue;
      const auto pair = static_cast<short>(t + 1);
      ::init_pair(pair, look.foreground, -1);
      attributes[t] |= static_cast<attr_t>(COLOR_PAIR(pair));
    }
  }
};

Terminal::Terminal(std::unique_ptr<Screen> screen) : screen_(std::move(screen)) {}
Terminal::~Terminal() = default;

Result<std::unique_ptr<Terminal>> Terminal::open(const TerminalOptions& options) {
  if (::isatty(STDIN_FILENO) == 0 || ::isatty(STDOUT_FILENO) == 0)
    return problem(ProblemKind::usage, "the screens need a terminal; from a script use the verbs: `ecs --help`");
  std::setlocale(LC_CTYPE, "");
  auto screen = std::make_unique<Screen>();
  screen->curses = ::newterm(nullptr, stdout, stdin);
  const char* name = std::getenv("TERM");
  if (screen->curses == nullptr)
    return problem(ProblemKind::usage, std::string("the terminal type TERM=") + (name == nullptr ? "" : name) +
                                           " is not known here; set TERM=vt100, or use the verbs: `ecs --help`");
  if (::tigetstr("cup") == nullptr || ::tigetstr("cup") == reinterpret_cast<char*>(-1))
    return problem(ProblemKind::usage, "this terminal cannot place the cursor; use the verbs: `ecs --help`");
  const bool utf8 = std::strcmp(::nl_langinfo(CODESET), "UTF-8") == 0;
  screen->glyphs = utf8 && !options.ascii ? Glyphs::unicode : Glyphs::ascii;
  ::raw();  // Ctrl-C is a key: the screens end in order
  ::noecho();
  ::nonl();
  ::keypad(stdscr, TRUE);
  ::set_escdelay(50);
  name_common_keys();
  if (options.mouse) ::mousemask(BUTTON1_PRESSED | BUTTON1_CLICKED | BUTTON4_PRESSED | BUTTON5_PRESSED, nullptr);
  screen->bytes_per_s = line_speed();
  screen->slow = screen->bytes_per_s < 3840.0;
  screen->choose_looks(has_colour(options));
  catch_crashes();
  return std::unique_ptr<Terminal>(new Terminal(std::move(screen)));
}

Canvas Terminal::canvas() const { return {LINES, COLS, screen_->glyphs, screen_->slow}; }

/// When the line will have carried this many cells: a pseudo-terminal does not tell.
void Terminal::Screen::reckon(int cells) {
  if (!slow) return;
  constexpr double kBytesPerCell = 2.0;  // with the moves between them
  const auto now = std::chrono::steady_clock::now();
  busy_until = std::max(busy_until, now) + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                               std::chrono::duration<double>(cells * kBytesPerCell / bytes_per_s));
}

/// Much of what was shown has not left for the terminal yet.
bool Terminal::Screen::behind() const {
  constexpr int kBytes = 48;  // at 9,600 baud a twentieth of a second
  if (slow && std::chrono::steady_clock::now() < busy_until) return true;
  int waiting = 0;
  return ::ioctl(STDOUT_FILENO, TIOCOUTQ, &waiting) == 0 && waiting > kBytes;
}

/// Writes the cells of a row that differ from what was sent, at most `room` of them. @return how many there is room for
int Terminal::Screen::write_row(const Canvas& canvas, int r, int room) {
  for (int c = 0; c < std::min(canvas.columns(), COLS); ++c) {
    if (r == LINES - 1 && c == COLS - 1) continue;  // writing there scrolls old terminals
    const Cell& cell = canvas.at(r, c);
    if (cell == sent.at(r, c) || cell.glyph == kSecondHalf) continue;
    if (room-- == 0) return 0;
    const bool agreed = ::wcwidth(static_cast<wchar_t>(cell.glyph)) == columns_of(cell.glyph);
    const std::array<wchar_t, 2> text{agreed ? static_cast<wchar_t>(cell.glyph) : L'?', 0};
    const attr_t looks = attributes[static_cast<std::size_t>(cell.tone)];
    cchar_t letter{};
    ::setcchar(&letter, text.data(), looks, static_cast<short>(PAIR_NUMBER(looks)), nullptr);
    if (!agreed && columns_of(cell.glyph) == 2) mvaddch(r, c + 1, ' ');
    mvadd_wch(r, c, &letter);
    const int behind = c + columns_of(cell.glyph);
    const bool halved = sent.at(r, behind).glyph == kSecondHalf;  // of a letter that was overwritten: to be sent again
    sent.put(r, c, cell.glyph, cell.tone);
    if (halved) sent.put(r, behind, kUnknown);
  }
  return room;
}

bool Terminal::show(const Canvas& canvas, CellPosition cursor, bool urgent) {
  constexpr int kPiece = 60;
  Screen& s = *screen_;
  if (!urgent && s.behind()) return false;
  if (s.sent.rows() != canvas.rows() || s.sent.columns() != canvas.columns()) {
    s.sent = Canvas(canvas.rows(), canvas.columns());
    ::erase();
  }
  const int rows = std::min(canvas.rows(), LINES);
  const int all = s.slow ? kPiece : rows * canvas.columns() + 1;
  int room = all;
  for (const int r : {0, rows - 1, rows - 2})
    if (r >= 0) room = s.write_row(canvas, r, room);
  for (int k = 0; k < rows && room > 0; ++k) {
    room = s.write_row(canvas, s.next_row % rows, room);
    if (room > 0) s.next_row = (s.next_row + 1) % rows;
  }
  ::curs_set(cursor.row >= 0 ? 1 : 0);
  if (cursor.row >= 0) move(cursor.row, cursor.column);
  refresh();
  s.reckon(all - room);
  return room > 0;
}

Key Terminal::read(int wait_ms) {
  timeout(wait_ms);
  wint_t code = 0;
  const int kind = get_wch(&code);
  if (kind == KEY_CODE_YES && code == KEY_RESIZE) screen_->sent = Canvas(0, 0);
  if (kind == ERR) return {};
  if (kind != KEY_CODE_YES) return key_of_letter(code);
  return code == KEY_MOUSE ? pressed_at() : key_of_code(code);
}

bool Terminal::copy(std::string_view text) {
  constexpr std::size_t kMost = 50'000;  // terminals cut more
  const char* const set = std::getenv("TERM");
  const std::string_view term = set == nullptr ? "" : set;
  constexpr std::string_view kKnown[] = {"xterm", "tmux",  "screen",  "rxvt", "alacritty",
                                         "foot",  "kitty", "wezterm", "st-"};
  if (text.size() > kMost || std::none_of(std::begin(kKnown), std::end(kKnown),
                                          [&](std::string_view known) { return term.starts_with(known); }))
    return false;
  const std::string sequence = "\033]52;c;" + base64_of(text) + "\a";
  std::size_t sent = 0;
  while (sent < sequence.size()) {
    const ssize_t written = ::write(STDOUT_FILENO, sequence.data() + sent, sequence.size() - sent);
    if (written <= 0) return false;
    sent += static_cast<std::size_t>(written);
  }
  return true;
}

void Terminal::redraw() { ::clearok(stdscr, TRUE); }

}  // namespace ecs::app
