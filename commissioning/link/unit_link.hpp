// The way to a unit: opens the chosen link (starting the bundled emulator where that is the link) and closes it.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "base/interrupt.hpp"
#include "commissioning/link/choice.hpp"
#include "commissioning/link/emulator_process.hpp"
#include "protocol/client/client.hpp"

namespace ecs::commissioning {

/// An open link. Destroying it closes the port and stops the emulator it started.
class UnitLink {
 public:
  [[nodiscard]] protocol::UnitClient& client() { return client_; }
  [[nodiscard]] const std::string& name() const { return name_; }  ///< as --link takes it
  /// The emulator behind the link, to keep it running when the link is closed; null: a real unit.
  [[nodiscard]] std::shared_ptr<EmulatorProcess> emulator() const { return emulator_; }
  /// Socket of the workshop around a bundled emulator; empty: none.
  [[nodiscard]] std::string workshop() const { return emulator_ ? emulator_->workshop() : std::string(); }
  [[nodiscard]] bool is_emulator() const { return emulator_ != nullptr; }

 private:
  friend Result<UnitLink> open_link(const LinkChoice& choice, const std::atomic<bool>& cancelled);
  UnitLink(std::shared_ptr<EmulatorProcess> emulator, protocol::UnitClient client, std::string name)
      : emulator_(std::move(emulator)), client_(std::move(client)), name_(std::move(name)) {}

  std::shared_ptr<EmulatorProcess> emulator_;  // before the client: it must outlive the open port
  protocol::UnitClient client_;
  std::string name_;
};

/// Opens a link; the flag cancels what is under way on it. An emulator that this program runs already with the same
/// machine serves again: whoever keeps emulator() keeps machine and unit as they are from one link to the next.
[[nodiscard]] Result<UnitLink> open_link(const LinkChoice& choice, const std::atomic<bool>& cancelled = interrupted());

}  // namespace ecs::commissioning
