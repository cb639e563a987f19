#include "commissioning/session/message.hpp"

#include "commissioning/session/event_log.hpp"

namespace ecs::commissioning {

void Message::say(const std::string& text, Tone tone) {
  text_ = text;
  tone_ = tone;
  log_event(tone, text);
}

}  // namespace ecs::commissioning
