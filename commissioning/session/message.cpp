#include "commissioning/session/message.hpp"

#include "commissioning/session/event_log.hpp"

namespace ecs::commissioning {

void Message::say(const std::string& text, Tone tone) {
  text_ = text;
  tone_ = tone;
  log_event(tone, text);
}

void Asking::ask(Question question, std::function<void()> on_yes, std::function<void()> on_no) {
  question_ = std::move(question);
  on_yes_ = std::move(on_yes);
  on_no_ = std::move(on_no);
}

void Asking::answer(bool yes) {
  const auto follow = yes ? std::move(on_yes_) : std::move(on_no_);
  *this = {};
  if (follow) follow();
}

}  // namespace ecs::commissioning
