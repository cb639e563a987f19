// The way to a unit: opens the chosen link (starting the bundled emulator where that is the link) and closes it. Units
// know this computer and its user by a key that all programs of the user share, and a name for records.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "base/process.hpp"
#include "commissioning/link/choice.hpp"
#include "commissioning/link/emulator_process.hpp"
#include "protocol/client/client.hpp"

namespace ecs::commissioning {

/// The key is kept in state_folder(); where that cannot be written, it is one by chance. Without a code.
[[nodiscard]] protocol::Host this_host();

/// $ECS_ARM_CODE; empty: not set.
[[nodiscard]] std::string arm_code_in_environment();

/// An open link. Destroying it closes the port and stops the emulator it started.
class UnitLink {
 public:
  [[nodiscard]] protocol::UnitClient& client() { return client_; }
  [[nodiscard]] const std::string& name() const { return name_; }  ///< as --link takes it
  /// The emulator that this program runs behind the link, to keep it running when the link is closed; null: none.
  [[nodiscard]] std::shared_ptr<EmulatorProcess> emulator() const { return emulator_.process; }
  /// Socket of the workshop around a bundled emulator; empty: none.
  [[nodiscard]] const std::string& workshop() const { return emulator_.workshop; }
  /// The bundled emulator, run by this program or by another one that shares it.
  [[nodiscard]] bool is_emulator() const { return emulator_.bundled; }
  [[nodiscard]] const std::string& emulator_arm_code() const { return emulator_.arm_code; }

 private:
  friend Result<UnitLink> open_link(const LinkChoice& choice, const std::atomic<bool>& cancelled);
  /// What is behind the link, if it is an emulator.
  struct Emulator {
    bool bundled = false;
    std::shared_ptr<EmulatorProcess> process;
    std::string workshop;
    std::string arm_code;
  };
  UnitLink(Emulator emulator, protocol::UnitClient client, std::string name)
      : emulator_(std::move(emulator)), client_(std::move(client)), name_(std::move(name)) {}

  Emulator emulator_;  // before the client: it must outlive the open port
  protocol::UnitClient client_;
  std::string name_;
};

/// Opens a link; the flag cancels what is under way on it. An emulator that this program runs already with the same
/// machine serves again: whoever keeps emulator() keeps machine and unit as they are from one link to the next. One
/// that another program runs and shares serves as well.
[[nodiscard]] Result<UnitLink> open_link(const LinkChoice& choice, const std::atomic<bool>& cancelled = interrupted());

}  // namespace ecs::commissioning
