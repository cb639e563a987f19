// A verb of `ecs-emulator` whose options are written into a request (docs/emulator.md).
// Does not live here: what a request does (ecs_emulator/workshop/workshop.hpp).
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "ecs_emulator/verbs/verb.hpp"

namespace ecs::emulator {

/// Every option that is given appears under its key. The request must live as long as the parsing.
class RequestVerb {
 public:
  RequestVerb(cli::Arguments& arguments, nlohmann::json& request) : arguments_(arguments), request_(request) {}

  void number(const std::string& option, const std::string& key, const std::string& help = "",
              Need need = Need::optional);
  void integer(const std::string& option, const std::string& key, const std::string& help = "",
               Need need = Need::optional);
  void word(const std::string& option, const std::string& key, const std::string& help = "",
            Need need = Need::optional);
  void flag(const std::string& option, const std::string& key, const std::string& help = "");
  /// Parted by commas.
  void numbers(const std::string& option, const std::string& key, const std::string& help = "");
  void words(const std::string& option, const std::string& key, const std::string& help = "");
  /// "y=-700,z=0" → {"Y": -700, "Z": 0}
  void coordinates(const std::string& option, const std::string& key, const std::string& help = "");
  /// Made absolute: the server that gets the request may work in another folder.
  void path(const std::string& option, const std::string& key, const std::string& help = "",
            Need need = Need::optional);
  void paths(const std::string& option, const std::string& key, const std::string& help = "");
  /// --force: see force_in().
  void force();

 private:
  cli::Arguments& arguments_;
  nlohmann::json& request_;
};

/// The options that a verb declares, as fields whose request is a member.
template <class Request>
[[nodiscard]] Fields<Request> request_fields(nlohmann::json Request::*member, void (*declare)(RequestVerb)) {
  nlohmann::json nothing;
  cli::Arguments declared;
  declare(RequestVerb(declared, nothing));
  Fields<Request> all;
  for (std::size_t k = 0; k < declared.size(); ++k)
    all.add({declared[k], [member, declare, k](Request& request) {
               cli::Arguments into;
               declare(RequestVerb(into, request.*member));
               return into[k].into;
             }});
  return all;
}

/// Options of the verbs that a running workshop and a machine without a unit share.
void add_measure_options(RequestVerb verb);
void add_capture_options(RequestVerb verb);
void add_survey_options(RequestVerb verb);
void add_components_options(RequestVerb verb);
void add_circle_options(RequestVerb verb);
void add_lengths_options(RequestVerb verb);
void add_run_options(RequestVerb verb);
void add_ball_options(RequestVerb verb);
void add_turn_options(RequestVerb verb);

/// Whether --force was given; the request itself does not hold it any more.
[[nodiscard]] bool force_in(nlohmann::json& request);
/// A `usage` problem if the request writes to a file that is there, unless `force`.
[[nodiscard]] Result<void> spared_by(const nlohmann::json& request, bool force);

/// Prints the answer of a workshop on stdout; what it refused is the problem.
[[nodiscard]] Result<Outcome> printed(const std::string& answer);
/// Draws the progress of a request on a terminal. @param line  {"progress": 0.25}
void show_progress(const std::string& line);

}  // namespace ecs::emulator
