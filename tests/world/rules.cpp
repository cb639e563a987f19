#include "tests/world/rules.hpp"

#include <algorithm>
#include <charconv>

#include "protocol/registers/unit_registers.hpp"

namespace ecs::world {

using namespace std::chrono_literals;
using protocol::Command;
using protocol::CommandCode;
using protocol::CommandResult;
using protocol::CommandState;

namespace {

constexpr Span kLongestAttempt = 10min;
/// A command that acts is carried out at most so long after it was sent: kMostAge_ms, and a period of the loop.
constexpr Span kMostAge = 2020ms;

/// The number behind `words`; nothing: they are not there.
std::optional<std::uint32_t> number_after(const std::string& text, std::string_view words) {
  const auto at = text.find(words);
  if (at == std::string::npos) return std::nullopt;
  std::uint32_t number = 0;
  const char* const from = text.data() + at + words.size();
  return std::from_chars(from, text.data() + text.size(), number).ec == std::errc() ? std::optional(number)
                                                                                    : std::nullopt;
}

std::uint64_t hash_of_meaning(const Bytes& pdu) {
  const Bytes meaning = meaning_of(pdu);
  return hash_of(0, meaning.data(), meaning.size());
}

}  // namespace

Bytes meaning_of(std::span<const std::uint8_t> pdu) {
  if (pdu.empty() || (pdu[0] != 16 && pdu[0] != 23)) return {};
  const std::size_t at = pdu[0] == 23 ? 5 : 1;
  if (pdu.size() < at + 5) return {};
  Bytes meaning{pdu[at], pdu[at + 1]};
  const bool echoed = (pdu[at] << 8 | pdu[at + 1]) != protocol::kBlockWrite.first;
  const std::size_t from = std::min(pdu.size(), at + (echoed ? 7 : 5));
  meaning.insert(meaning.end(), pdu.begin() + static_cast<std::ptrdiff_t>(from), pdu.end());
  return meaning;
}

std::uint64_t hash_of(std::uint64_t hash, const void* data, std::size_t size) {
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 0x100000001B3ULL;
  return hash;
}

bool holds(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

Record::Record(const Schedule& schedule, std::function<void(const std::string&)> say)
    : schedule_(schedule), say_(std::move(say)) {
  report.trace = 0xCBF29CE484222325ULL;
}

double Record::seconds() const { return std::chrono::duration<double>(schedule_.now() - Time{1h}).count(); }

Rules::Rules(Record& record, const Schedule& schedule, Place& place, std::span<const Bytes> images, bool lying_disk)
    : record_(record), schedule_(schedule), place_(place), images_(images), lying_disk_(lying_disk) {}

void Rules::meant(const Bytes& pdu) { meant_at_.emplace(hash_of_meaning(pdu), schedule_.now()); }

void Rules::arrives(const Bytes& pdu) {
  meaning_ = hash_of_meaning(pdu);
  if (carried_out_meanings_.count(meaning_) > 0) record_.reached(Sometimes::replayed_command_ignored);
}

/// Only what a host with the code has sent may write, commit or move an output; once, and in time.
void Rules::before_command(const Command& command) {
  record_.say("the unit is asked for \"{}\", session {:08X}, sequence {}", name_of(command.code), command.asker.session,
              command.sequence);
  if (protocol::needs_arming(command.code)) {
    const auto sent = meant_at_.find(meaning_);
    if (sent == meant_at_.end())
      return record_.violated("\"{}\" was carried out that no host with the code has given", name_of(command.code));
    carried_out_meanings_.insert(meaning_);
    if (!carried_out_.insert({command.asker.session, command.sequence}).second)
      record_.violated("\"{}\" was carried out twice", name_of(command.code));
    if (protocol::acts_at_once(command.code)) {
      if (schedule_.now() - sent->second > kMostAge)
        record_.violated("\"{}\" was carried out {:.3f} s after it was given", name_of(command.code),
                         std::chrono::duration<double>(schedule_.now() - sent->second).count());
      if (stopped_ > sent->second)
        record_.violated("\"{}\" was carried out after something else had switched off", name_of(command.code));
    }
  }
  if (command.code == CommandCode::output_compensation && command.relay_on) output_asked_ = schedule_.now();
}

void Rules::after_command(const Command& command, const CommandResult& result) {
  if (result.state != CommandState::done && result.state != CommandState::busy) return;
  if (protocol::switches_off(command.code)) stopped_ = schedule_.now();
  if (protocol::switches_off(command.code) && command.code != CommandCode::stop) opened_ = schedule_.now();
}

void Rules::before_write(Address address, std::span<const std::uint8_t> bytes) {
  if (meant_at_.count(meaning_) == 0)
    record_.violated("{} bytes at {:06X} were written that no host with the code has sent", bytes.size(), address);
}

void Rules::unit_started() {
  carried_out_.clear();
  seen_version_.reset();
  drives_ = {};
}

void Rules::look_at_map() {
  if (seen_version_ == place_.version()) return;
  seen_version_ = place_.version();
  const Bytes active = place_.active();
  Held now{schedule_.now(), std::nullopt, place_.commit()};
  const auto found = std::find(images_.begin(), images_.end(), active);
  if (found != images_.end()) now.image = static_cast<std::size_t>(found - images_.begin());
  const bool known = held_.empty() ? !now.image && now.commit == 0
                                   : held_.back().image == now.image && held_.back().commit == now.commit;
  if (known && !held_.empty()) return;
  if (!now.image && !held_.empty()) {
    CompiledMap map;
    const bool refused =
        emulator::test_map(place_.unit().memory(), place_.unit().settings().axis_modules, map).fault != Fault::none;
    if (now.commit == 0 && !held_.front().image && promised_ == 0)
      record_.say("the commit is undone, there is no map as before");
    else if (place_.disk.torn() && refused)
      record_.reached(Sometimes::torn_file_refused_or_isolated);
    else if (refused && !place_.running() && place_.unit().status().ram_test == protocol::TestOutcome::failed)
      record_.say("the supply was lost within the RAM test, and the map is refused");
    else
      record_.violated("the active map is none that was sent ({} bytes, commit {})", active.size(), now.commit);
  }
  record_.say("active: map {}, commit {}", now.image ? static_cast<int>(*now.image) : -1, now.commit);
  record_.trace(&now.commit, sizeof now.commit);
  if (!lying_disk_) {
    if (now.commit < promised_) record_.violated("commit {} is active, {} was told before", now.commit, promised_);
    for (const NotTaken& told : not_taken_)
      if (!told.over && now.image == told.image)
        record_.violated("map {} is active, and a host was told that it was not taken", told.image);
  }
  held_.push_back(now);
}

/// A relay that closes, or an output that changes, was asked for just now by a host with the code (before_command()).
void Rules::look_at_outputs() {
  place_.catch_up();
  const emulator::Drives now = place_.drives();
  for (std::size_t a = 0; a < kAxes; ++a) {
    const bool closed = now[a].relay_closed && !drives_[a].relay_closed;
    if (now[a].relay_closed && place_.unit().mode() == UnitMode::compensating) continue;
    if (closed) record_.reached(Sometimes::output_closed);
    if (now[a].relay_closed && opened_ > output_asked_ && schedule_.now() - opened_ > 40ms)
      record_.violated("a relay is closed after everything was switched off");
    if (!now[a].relay_closed && drives_[a].relay_closed && schedule_.now() - output_asked_ > 59s)
      record_.reached(Sometimes::output_ended_by_silence);
  }
  drives_ = now;
}

bool Rules::was_held(Time from, Time to, const std::function<bool(const Held&)>& held) const {
  for (std::size_t i = 0; i < held_.size(); ++i) {
    const bool over = i + 1 < held_.size() && held_[i + 1].since < from;
    if (!over && held_[i].since <= to && held(held_[i])) return true;
  }
  return false;
}

void Rules::begins(const Attempt& attempt) {
  for (NotTaken& told : not_taken_) told.over = told.over || told.image == attempt.image;
}

/// What was told against what was so: of the time between the last answer to this host and the end.
void Rules::ends(const Attempt& attempt, const Result<commissioning::SentMap>& sent, bool cancelled,
                 std::span<const Attempt* const> others) {
  const Time now = schedule_.now(), since = attempt.answered_since;
  const auto is_sent = [&](const Held& held) { return held.image == attempt.image; };
  const auto end = [&](std::string verdict) {
    record_.say("{}: {}{}", attempt.host, verdict, sent ? std::string() : ": " + to_text(sent.error()));
    record_.trace(verdict.data(), verdict.size());
    ++record_.report.endings[std::move(verdict)];
  };
  if (now - attempt.begun > kLongestAttempt)
    record_.violated("{}: an upload took {} s", attempt.host,
                     std::chrono::duration_cast<std::chrono::seconds>(now - attempt.begun).count());
  if (sent) {
    if (!was_held(since, now, is_sent))
      return record_.violated("{}: success was told, map {} is not active", attempt.host, attempt.image);
    if (sent->report.already_held) record_.reached(Sometimes::already_held);
    if (sent->report.bytes_sent < sent->report.bytes && !sent->report.already_held) record_.reached(Sometimes::resumed);
    if (attempt.settles) record_.reached(Sometimes::settled_as_active);
    if (attempt.armed_in_it) record_.reached(Sometimes::armed_again_in_transfer);
    promised_ = std::max(promised_, sent->report.commit_sequence);
    return end(sent->report.already_held ? "right, already held" : "right");
  }
  const std::string& words = sent.error().message;
  record_.trace(words.data(), words.size());
  const bool says_none = holds(words, "the unit contains no map, as before");
  const auto old_commit = number_after(words, "the old map is active (commit no. ");
  const auto new_commit = number_after(words, "it is active (commit no. ");
  const bool doubt = holds(words, "it is not known which map is active") ||
                     holds(words, "the active map has changed") || holds(words, "another map is now active") ||
                     holds(words, "the active map in the unit differs") ||
                     holds(words, "unless another host has sent one");
  if (new_commit) {
    if (!was_held(attempt.begun, now, [&](const Held& held) { return is_sent(held) && held.commit == *new_commit; }))
      return record_.violated("{}: told that the new map is active (commit {}), it was not: {}", attempt.host,
                              *new_commit, words);
    promised_ = std::max(promised_, *new_commit);
    record_.reached(Sometimes::told_new_with_failure);
    if (cancelled) record_.reached(Sometimes::cancelled_after_commit);
    return end("new, told");
  }
  if (old_commit || says_none) {
    if (!was_held(since, now, [&](const Held& held) { return held.commit == old_commit.value_or(0); }))
      return record_.violated("{}: told that the old map is active, it was not: {}", attempt.host, words);
    not_taken_.push_back({now, attempt.image, false});
    for (const Attempt* other : others)
      if (other->image == attempt.image) not_taken_.back().over = true;
    record_.reached(Sometimes::told_old);
    return end("old, told");
  }
  if (doubt) {
    record_.reached(Sometimes::told_in_doubt);
    if (holds(words, "the active map has changed")) record_.reached(Sometimes::another_host_committed);
    return end(was_held(now, now, is_sent) ? "in doubt, new active" : "in doubt, old active");
  }
  if (attempt.staging)
    return record_.violated("{}: a failure that does not name the active map: {}", attempt.host, words);
  end("before staging");
}

}  // namespace ecs::world
