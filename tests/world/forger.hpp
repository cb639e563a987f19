// Somebody on the line without the code, who sends what no host sends: requests heard before, blocks and commands
// changed, answers in the unit's place, guesses of the code. Does not live here: hosts without the code that keep to
// the protocol (world.cpp).
#pragma once

#include <deque>
#include <map>

#include "tests/world/line.hpp"

namespace ecs::world {

class Forger {
 public:
  Forger(Schedule& schedule, Random& random, Line& line);
  /// Every frame on the line, its own as well.
  void hear(int from, int to, const Bytes& frame);
  /// More than a unit remembers.
  void open_sessions();
  void fall_silent() { silent_ = true; }

 private:
  struct Request {
    int from = 0;
    Bytes pdu;
  };
  void act();
  void on_request(const Request& request);
  void on_reply(int to, const Bytes& pdu);
  void answer(int to, const Bytes& reply);
  void send(const Bytes& pdu, int as, Span later = {});
  void send_block(const protocol::Block& block, const protocol::Registers& values, const protocol::Block& answer,
                  int as, Span later = {});
  [[nodiscard]] Bytes changed(Bytes pdu);
  [[nodiscard]] Bytes answer_to(const Bytes& request);
  void open_session(std::uint16_t version, Span later = {});
  void guess();
  void give_command();
  [[nodiscard]] std::uint32_t draw(std::uint32_t count);
  [[nodiscard]] Span draw(Span from, Span to);

  Schedule& schedule_;
  Random& random_;
  Line& line_;
  int number_;
  bool silent_ = false;
  // what this one does
  bool hears_, replays_, changes_, answers_, guesses_, impersonates_, speaks_in_others_place_;
  double often_;
  std::deque<Request> requests_;
  std::map<Bytes, Bytes> replies_;  ///< by the request behind its echo
  std::map<int, Bytes> asked_;      ///< the last request of each
  std::uint32_t own_session_ = 0, other_session_ = 0;
};

}  // namespace ecs::world
