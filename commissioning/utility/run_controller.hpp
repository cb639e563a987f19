// RUN USER SOFTWARE: which program with which argument, what it returned, the registers it left.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/unit/utility_work.hpp"
#include "commissioning/utility/unit_view.hpp"
#include "core/address_map.hpp"

namespace ecs::commissioning {

/// What is to be run.
struct UserProgram {
  Address address = kUserPrograms;
  std::uint32_t argument = 0;
  double wait_s = 60.0;
};
/// Every field that is wrong at once. @param address @param argument  decimal or 0x…
[[nodiscard]] Result<UserProgram> program_in(const std::string& address, const std::string& argument,
                                             const std::string& wait_s);

/// A stretch of memory as a program sees it.
struct ProgramRegion {
  Region region;
  std::string what;
  bool runs = false;  ///< programs can lie there
};
[[nodiscard]] std::vector<ProgramRegion> program_regions();

class RunController {
 public:
  static constexpr std::size_t kPeekBytes = 8;
  struct Ended {
    UserProgram program;
    std::optional<std::uint32_t> returned;  ///< nothing: it failed, see `why`
    std::string why;
    std::vector<KeptRegister> registers;  ///< empty: they could not be read
    double took_s = 0.0;
  };
  explicit RunController(std::shared_ptr<UnitConnection> connection);

  /// Reads the first bytes at the address; the question is there when they came.
  void prepare(const UserProgram& program);
  /// To be asked now, once.
  [[nodiscard]] std::optional<Question> take_question();
  /// @pre prepared
  void run();
  void cancel();
  [[nodiscard]] bool busy() const { return peeking_.running() || running_.running(); }
  [[nodiscard]] bool running() const { return running_.running(); }
  [[nodiscard]] double running_s() const;
  [[nodiscard]] const UserProgram& program() const { return program_; }
  [[nodiscard]] const std::optional<Ended>& ended() const { return ended_; }
  [[nodiscard]] bool advance();
  [[nodiscard]] const UnitView& unit() const { return unit_; }
  [[nodiscard]] Message& message() { return message_; }
  [[nodiscard]] const Message& message() const { return message_; }

 private:
  using Bytes = std::vector<std::uint8_t>;
  void ask(const Bytes& first);
  void take(Result<Ended> ended);

  std::shared_ptr<UnitConnection> connection_;
  UnitView unit_;
  UserProgram program_;
  std::optional<Question> question_;
  std::optional<Ended> ended_;
  int shown_s_ = 0;
  Message message_;
  TaskRunner peeking_;
  TaskRunner running_;
};

}  // namespace ecs::commissioning
