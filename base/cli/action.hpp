// An action of a program, once: a plain request whose fields are described beside it, what runs with it, and what is
// said of it. Does not live here: which actions a program has (its registry), parsing (command_tree.hpp).
#pragma once

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "base/outcome.hpp"

namespace ecs {
struct Cell;
Outcome outcome_of(const Cell& answer, int exit_code);
}  // namespace ecs

namespace ecs::cli {

enum class Need { optional, required };

/// What is called with the value of an argument that was given.
using OnFlag = std::function<void()>;
using OnNumber = std::function<void(double)>;
using OnInteger = std::function<void(long long)>;
using OnText = std::function<void(const std::string&)>;
using OnNumbers = std::function<void(const std::vector<double>&)>;
using OnTexts = std::function<void(const std::vector<std::string>&)>;

/// An argument named in capitals ("FILE") is taken by its place, one with dashes ("-o,--output") by its name.
struct Argument {
  using Target =
      std::variant<std::string*, std::vector<std::string>*, double*, std::optional<double>*, int*, std::size_t*,
                   std::optional<std::uint64_t>*, bool*, OnFlag, OnNumber, OnInteger, OnText, OnNumbers, OnTexts>;

  std::string name;
  Target into;
  std::string help;
  Need need = Need::optional;
  double least = std::numeric_limits<double>::lowest();  ///< of a number
  double most = std::numeric_limits<double>::max();
  std::vector<std::string> choices{};  ///< the words that are allowed, whatever their case; empty: any text
  bool by_commas = false;              ///< of many values: one word holds them, parted by commas
  bool is_output = false;              ///< names a file that the action writes
  bool is_secret = false;              ///< never noted or logged
  std::string heading{};               ///< of its group in the help; empty: with the other options

  [[nodiscard]] bool by_place() const { return !name.starts_with('-'); }
  [[nodiscard]] bool is_flag() const {
    return std::holds_alternative<bool*>(into) || std::holds_alternative<OnFlag>(into);
  }
  [[nodiscard]] bool takes_many() const {
    return std::holds_alternative<std::vector<std::string>*>(into) || std::holds_alternative<OnTexts>(into) ||
           std::holds_alternative<OnNumbers>(into);
  }
  /// A preset that means something, as the help shows it; else empty.
  [[nodiscard]] std::string preset() const;
};
using Arguments = std::vector<Argument>;

// --- what may be said of a field beside its name, place and help

/// Of a number; integers need one.
struct Range {
  double least = std::numeric_limits<double>::lowest();
  double most = std::numeric_limits<double>::max();
};
using Words = std::vector<std::string>;
enum class Is { output, secret };

inline void say(Argument& argument, Need need) { argument.need = need; }
inline void say(Argument& argument, Range range) { argument.least = range.least, argument.most = range.most; }
inline void say(Argument& argument, Words words) { argument.choices = std::move(words); }
inline void say(Argument& argument, Is is) { (is == Is::output ? argument.is_output : argument.is_secret) = true; }

/// The fields of a request in the order of its help, each written once:
///
///     struct PlotRequest {
///       std::string file, plot;
///       int points = 100;
///       ImportRequest import;
///       static cli::Fields<PlotRequest> fields() {
///         using R = PlotRequest;
///         return {{"FILE", &R::file, "what to draw", Need::required},
///                 {"--plot", &R::plot, "OUT.svg or OUT.png", Is::output},
///                 {"--points", &R::points, "of the curve", Range{2, 1000}},
///                 &R::import};
///       }
///     };
template <class Request>
class Fields;

/// Those that the request declares.
template <class Request>
[[nodiscard]] const Fields<Request>& fields_of() {
  static const Fields<Request> all = Request::fields();
  return all;
}

template <class Request>
class Fields {
 public:
  /// Where the value of a field lies in a request.
  using Place = std::function<Argument::Target(Request&)>;

  Fields() = default;
  template <class Owner, class Value, class... More>
  requires std::derived_from<Request, Owner> Fields(std::string name, Value Owner::*member, std::string help,
                                                    More... more)
      : Fields(Argument{std::move(name), {}, std::move(help)}, [member](Request& r) { return &(r.*member); }) {
    (say(all_.front().first, std::move(more)), ...);
  }
  /// A field that is no member.
  Fields(Argument argument, Place place) { all_.emplace_back(std::move(argument), std::move(place)); }
  /// Those of a group that requests share, as it declares them or as given here.
  template <class Owner, class Group>
  requires std::derived_from<Request, Owner> Fields(Group Owner::*member,
                                                    const Fields<Group>& group = fields_of<Group>()) {
    for (const auto& [argument, place] : group.all_)
      all_.emplace_back(argument, [member, place = place](Request& r) { return place(r.*member); });
  }
  Fields(std::initializer_list<Fields> parts) {
    for (const Fields& part : parts) add(part);
  }

  void add(const Fields& more) { all_.insert(all_.end(), more.all_.begin(), more.all_.end()); }
  /// The same below a heading of their own.
  [[nodiscard]] Fields under(const std::string& heading) && {
    for (auto& [argument, place] : all_) argument.heading = heading;
    return std::move(*this);
  }
  /// They fill this request.
  [[nodiscard]] Arguments arguments_for(Request& request) const {
    Arguments arguments;
    for (const auto& [argument, place] : all_) {
      arguments.push_back(argument);
      arguments.back().into = place(request);
    }
    return arguments;
  }

 private:
  template <class Other>
  friend class Fields;
  std::vector<std::pair<Argument, Place>> all_;
};

enum class Link {
  none,
  reads,
  arms,       ///< decides who may write; says EMULATOR once the link is open
  may_write,  ///< but its messages do not say what the unit is
  writes,     ///< or moves, or runs: every message says EMULATOR where that is the unit, refusals included
};
/// When a run is worth an entry in the logbook.
enum class Logged {
  never,
  when_written,  ///< it wrote a file: what it shows alone changes nothing
  always,        ///< what it found is the result
};

/// What is said of an action beside its words, here and in no other list.
struct Properties {
  Link link = Link::none;
  Logged logged = Logged::never;
  const char* kind = "";       ///< of its entry in the logbook
  const char* logged_as = "";  ///< in that entry; empty: its path
  bool live = false;           ///< asks while it runs: a screen shows it as it goes
};

/// What every action of a program takes.
struct Shared {
  Arguments always{};       ///< first in the help
  std::string* link{};      ///< of --link, for an action that needs one
  std::string* arm_code{};  ///< of --arm-code
};

/// What an action writes replaces nothing: an output file that is there is refused unless --force is given. The file
/// that it takes first is changed in place, unless it refuses that itself; so is that of --NAME by --NAME-out.
class OutputGuard {
 public:
  /// Adds --force where an argument is an output file and no flag of that name is there.
  explicit OutputGuard(Arguments& arguments);
  /// A `usage` problem for the first file that would be overwritten.
  [[nodiscard]] Result<void> check() const;

 private:
  Arguments arguments_;
  std::shared_ptr<bool> own_force_;
  const bool* force_ = nullptr;
};

/// The words of a path: {"utility", "datum", "record"} of "utility datum record".
[[nodiscard]] std::vector<std::string> words_of(const std::string& path);

/// @tparam Context  the runner: what a program gives to what it runs
template <class Context>
struct Action {
  using Run = std::function<Result<Outcome>(Context&)>;
  /// A request of its own, and what runs with it. The arguments fill that request as long as `run` lives.
  struct Bound {
    Arguments arguments;
    Run run;
  };

  std::string path;  ///< "utility datum record"
  std::string help;
  std::string example;  ///< one or more full command lines
  Properties is;
  std::function<Bound(const Shared&)> bound;

  [[nodiscard]] std::vector<std::string> words() const { return words_of(path); }
};

/// Own arguments with those that every action takes.
[[nodiscard]] Arguments with_shared(Arguments own, const Shared& shared, Link link);

/// An action by its parts. What it answers is an Outcome, or has describe(), and holds() where it may not hold.
template <class Context, class Request, class Answer>
[[nodiscard]] Action<Context> action(std::string path, std::string help, std::string example,
                                     std::function<Result<Answer>(Context&, const Request&)> work, Properties is,
                                     std::function<Fields<Request>()> fields) {
  return {std::move(path), std::move(help), std::move(example), is, [=](const Shared& shared) {
            const auto request = std::make_shared<Request>();
            typename Action<Context>::Bound bound{with_shared(fields().arguments_for(*request), shared, is.link), {}};
            bound.run = [work, request, guard = OutputGuard(bound.arguments)](Context& context) -> Result<Outcome> {
              ECS_DO(guard.check());
              ECS_TRY(answer, work(context, *request));
              if constexpr (std::is_same_v<Answer, Outcome>)
                return answer;
              else if constexpr (requires { answer.holds(); })
                return outcome_of(describe(answer), answer.holds() ? kDone : kDoesNotHold);
              else
                return outcome_of(describe(answer), kDone);
            };
            return bound;
          }};
}
template <class Context, class Request, class Answer>
[[nodiscard]] Action<Context> action(std::string path, std::string help, std::string example,
                                     Result<Answer> (*work)(Context&, const Request&), Properties is = {}) {
  return action<Context, Request, Answer>(std::move(path), std::move(help), std::move(example), work, is,
                                          [] { return fields_of<Request>(); });
}

/// A group of actions; a menu may hold menus ("utility datum").
struct Menu {
  std::string path;  ///< empty: the program itself
  std::string help;
  Arguments arguments{};
};

/// Actions that belong together, and the menu or action that they follow in the help.
template <class Context>
struct Family {
  const char* after = "";
  const std::vector<Action<Context>>* actions{};
};

/// Every menu and action, in the order in which the help shows them; the actions of a menu are adjacent.
template <class Context>
struct Registry {
  std::vector<Menu> menus;
  std::vector<const Action<Context>*> actions;

  /// Behind what it follows, and behind those that were put there before; at the end if that is not there.
  void add(const Family<Context>& family) {
    const Action<Context>*& before = last_behind_[family.after];
    const std::string name = family.after;
    const auto follows = [&](const Action<Context>* one) {
      return before != nullptr ? one == before : one->path == name || one->path.starts_with(name + " ");
    };
    auto at = std::find_if(actions.rbegin(), actions.rend(), follows).base();
    if (at == actions.begin()) at = actions.end();
    for (const Action<Context>& one : *family.actions) at = actions.insert(at, before = &one) + 1;
  }

  /// "" where no menu has that path.
  [[nodiscard]] std::string menu_help(const std::string& path) const {
    for (const Menu& menu : menus)
      if (menu.path == path) return menu.help;
    return {};
  }

 private:
  std::map<std::string, const Action<Context>*> last_behind_;
};

/// A request without fields.
struct Nothing {
  static Fields<Nothing> fields() { return {}; }
};

}  // namespace ecs::cli
