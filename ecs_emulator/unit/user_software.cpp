// The processor emulation Unicorn (GPL-2) is loaded when a program is to run: the emulator works without it and is no
// work derived from it.
#include "ecs_emulator/unit/user_software.hpp"

#include <algorithm>
#include <optional>
#include <type_traits>
#include <vector>

#include <dlfcn.h>
#include <fmt/format.h>
#include <unicorn/unicorn.h>

namespace ecs::emulator {
/// Functions of libunicorn by the names of its header, without "uc_".
#define ECS_PROCESSOR_FUNCTIONS(F) \
  F(open)                          \
  F(close)                         \
  F(ctl)                           \
  F(strerror)                      \
  F(reg_read) F(reg_write) F(mem_read) F(mem_write) F(mem_map) F(mmio_map) F(hook_add) F(emu_start) F(emu_stop)

struct ProcessorLibrary {
#define F(name) decltype(&uc_##name) name{nullptr};  // NOLINT(bugprone-macro-parentheses): a name that is declared
  ECS_PROCESSOR_FUNCTIONS(F)
#undef F
};

namespace {

constexpr const char* kSharedObject = "libunicorn.so.2";

std::optional<ProcessorLibrary> loaded() {
  void* const library = ::dlopen(kSharedObject, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return std::nullopt;
  bool whole = true;
  const auto take = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(::dlsym(library, name));
    whole = whole && function != nullptr;
  };
  ProcessorLibrary functions;
#define F(name) take(functions.name, "uc_" #name);
  ECS_PROCESSOR_FUNCTIONS(F)
#undef F
  if (!whole) return std::nullopt;
  return functions;
}

/// Null where the library is not installed (Debian: libunicorn2).
const ProcessorLibrary* processor_library() {
  static const std::optional<ProcessorLibrary> library = loaded();
  return library ? &*library : nullptr;
}

constexpr Address kReturnTo = 0x0007FC;  ///< in the EPROM; nothing is executed there
constexpr std::uint16_t kSupervisor = 0x2700;
constexpr std::array<int, 8> kData{UC_M68K_REG_D0, UC_M68K_REG_D1, UC_M68K_REG_D2, UC_M68K_REG_D3,
                                   UC_M68K_REG_D4, UC_M68K_REG_D5, UC_M68K_REG_D6, UC_M68K_REG_D7};
constexpr std::array<int, 8> kAddress{UC_M68K_REG_A0, UC_M68K_REG_A1, UC_M68K_REG_A2, UC_M68K_REG_A3,
                                      UC_M68K_REG_A4, UC_M68K_REG_A5, UC_M68K_REG_A6, UC_M68K_REG_A7};

/// Vectors of the 68000 that a program can meet.
std::string name_of_exception(std::uint32_t vector) {
  constexpr std::array<std::string_view, 12> kNames{"",
                                                    "",
                                                    "",
                                                    "",
                                                    "illegal instruction",
                                                    "division by zero",
                                                    "CHK out of bounds",
                                                    "TRAPV",
                                                    "privilege violation",
                                                    "",
                                                    "line A instruction",
                                                    "line F instruction"};
  if (vector < kNames.size() && !kNames[vector].empty()) return std::string(kNames[vector]);
  return vector >= 32 && vector < 48 ? fmt::format("TRAP #{}", vector - 32) : fmt::format("exception {}", vector);
}

std::uint64_t big_endian(ByteView bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

}  // namespace

struct UserSoftware::Processor {
  UnitMemory& memory;
  const ProcessorLibrary* library = processor_library();
  uc_engine* engine = nullptr;
  std::vector<uc_hook> hooks = std::vector<uc_hook>(5);
  std::array<std::uint8_t, 20> inputs{};
  UserEnd end = UserEnd::running;
  std::string why;
  std::uint64_t instructions = 0;
  std::uint64_t allowed = 0;
  Address written_first = ~Address{0};
  Address written_last = 0;
  Address pc = 0;

  explicit Processor(UnitMemory& of) : memory(of) {}
  Processor(const Processor&) = delete;
  Processor& operator=(const Processor&) = delete;
  ~Processor() {
    if (engine != nullptr) library->close(engine);
  }

  [[nodiscard]] std::uint32_t reg(int which) const {
    std::uint32_t value = 0;
    library->reg_read(engine, which, &value);
    return value;
  }
  void set(int which, std::uint32_t value) { library->reg_write(engine, which, &value); }

  void trap(std::string reason) {
    if (end != UserEnd::running) return;
    end = UserEnd::trapped;
    why = std::move(reason);
    library->emu_stop(engine);
  }

  void take_back() {
    if (written_first > written_last) return;
    std::vector<std::uint8_t> bytes(written_last - written_first + 1);
    library->mem_read(engine, written_first, bytes.data(), bytes.size());
    memory.write(written_first, bytes);
    load(written_first, static_cast<std::uint32_t>(bytes.size()));  // a stuck bit shows
    written_first = ~Address{0};
    written_last = 0;
  }
  void load(Address first, std::uint32_t size) {
    const ByteView bytes = memory.view(first, size);
    library->mem_write(engine, first, bytes.data(), bytes.size());
  }

  // what the processor calls
  static void on_instruction(uc_engine* /*engine*/, std::uint64_t address, std::uint32_t /*size*/, void* self_) {
    auto& self = *static_cast<Processor*>(self_);
    self.pc = static_cast<Address>(address);
    ++self.instructions;
  }
  /// Between two blocks of instructions the condition codes are in their register: there it may stop and go on.
  static void on_block(uc_engine* engine, std::uint64_t /*address*/, std::uint32_t /*size*/, void* self_) {
    const auto& self = *static_cast<Processor*>(self_);
    if (self.instructions >= self.allowed) self.library->emu_stop(engine);
  }
  static void on_access(uc_engine* /*engine*/, uc_mem_type type, std::uint64_t address, int size, std::int64_t /*v*/,
                        void* self_) {
    auto& self = *static_cast<Processor*>(self_);
    if (size > 1 && address % 2 != 0)
      return self.trap(fmt::format("address error: odd address 0x{:06X} at PC 0x{:06X}", address, self.pc));
    if (type != UC_MEM_WRITE || !kSystemRam.contains(static_cast<Address>(address))) return;
    self.written_first = std::min(self.written_first, static_cast<Address>(address));
    self.written_last = std::max(self.written_last, static_cast<Address>(address) + static_cast<Address>(size) - 1);
  }
  static bool on_illegal(uc_engine* /*engine*/, uc_mem_type type, std::uint64_t address, int /*size*/,
                         std::int64_t /*value*/, void* self_) {
    auto& self = *static_cast<Processor*>(self_);
    const bool write = type == UC_MEM_WRITE_UNMAPPED || type == UC_MEM_WRITE_PROT;
    const bool fetch = type == UC_MEM_FETCH_UNMAPPED || type == UC_MEM_FETCH_PROT;
    const std::string_view what = write ? "write to" : (fetch ? "jump to" : "read of");
    self.trap(fmt::format("bus error: {} 0x{:06X} at PC 0x{:06X}", what, address, self.pc));
    return false;
  }
  static void on_exception(uc_engine* /*engine*/, std::uint32_t vector, void* self_) {
    auto& self = *static_cast<Processor*>(self_);
    self.trap(fmt::format("{} at PC 0x{:06X}", name_of_exception(vector), self.pc));
  }

  /// A stretch that is read and written through the unit's memory, so that stuck bits and lost power act at once.
  struct Window {
    Processor* self;
    Address first;
  };
  std::array<Window, 4> windows{};
  static std::uint64_t on_window_read(uc_engine* /*engine*/, std::uint64_t offset, unsigned size, void* window_) {
    const auto& window = *static_cast<Window*>(window_);
    const Address address = window.first + static_cast<Address>(offset);
    if (window.first == kMachineInputs.first && offset + size <= window.self->inputs.size())
      return big_endian(ByteView(window.self->inputs).subspan(offset, size));
    if (window.self->memory.exists(address, size)) return big_endian(window.self->memory.view(address, size));
    window.self->trap(fmt::format("bus error: read of 0x{:06X} at PC 0x{:06X}", address, window.self->pc));
    return 0;
  }
  static void on_window_write(uc_engine* /*engine*/, std::uint64_t offset, unsigned size, std::uint64_t value,
                              void* window_) {
    const auto& window = *static_cast<Window*>(window_);
    const Address address = window.first + static_cast<Address>(offset);
    if (!window.self->may_write(address, size))
      return window.self->trap(fmt::format("bus error: write to 0x{:06X} at PC 0x{:06X}", address, window.self->pc));
    for (unsigned i = 0; i < size; ++i)
      window.self->memory.write(address + i, static_cast<std::uint8_t>(value >> (8 * (size - 1 - i))));
  }

  [[nodiscard]] bool may_write(Address address, unsigned size) const {
    if (!in_axis_memory(address)) return memory.writable(address, size);
    return memory.exists(address, size) && !in_active_bank(memory, address);
  }

  void map_window(std::size_t number, Address first, std::uint32_t size) {
    constexpr std::uint32_t kPage = 0x1000;
    windows[number] = {this, first};
    library->mmio_map(engine, first, (size + kPage - 1) / kPage * kPage, on_window_read, &windows[number],
                      on_window_write, &windows[number]);
  }
  template <class F>
  void hook(std::size_t number, int types, F* function) {
    library->hook_add(engine, &hooks[number], types, reinterpret_cast<void*>(function), this, std::uint64_t{1},
                      std::uint64_t{0});
  }
  void map_memory() {
    library->mem_map(engine, kEprom.first, kEprom.size, UC_PROT_READ | UC_PROT_EXEC);
    library->mem_map(engine, kSystemRam.first, kSystemRam.size, UC_PROT_ALL);
    load(kEprom.first, kEprom.size);
    load(kSystemRam.first, kSystemRam.size);
    map_window(0, kMachineInputs.first, kMachineInputs.size);
    map_window(1, kCommitRecords.first, kCommitRecords.size);
    map_window(2, kBankA.first, bank_bytes(memory.modules()));
    map_window(3, kBankB.first, bank_bytes(memory.modules()));
    hook(0, UC_HOOK_CODE, on_instruction);
    hook(1, UC_HOOK_MEM_READ | UC_HOOK_MEM_WRITE, on_access);
    hook(2, UC_HOOK_MEM_INVALID, on_illegal);
    hook(3, UC_HOOK_INTR, on_exception);
    hook(4, UC_HOOK_BLOCK, on_block);
  }
};

bool UserSoftware::may_start_at(Address start) {
  return start >= kUserPrograms && kSystemRam.contains(start) && start % 2 == 0;
}

UserSoftware::UserSoftware(UnitMemory& memory, Address start, std::uint32_t argument)
    : processor_(std::make_unique<Processor>(memory)) {
  Processor& p = *processor_;
  if (p.library == nullptr) {
    p.end = UserEnd::trapped;
    p.why = "the processor emulation is not installed (libunicorn2)";
    return;
  }
  if (p.library->open(UC_ARCH_M68K, UC_MODE_BIG_ENDIAN, &p.engine) != UC_ERR_OK) {
    p.end = UserEnd::trapped;
    p.why = "the processor emulation does not start";
    return;
  }
  p.library->ctl(p.engine, UC_CTL_WRITE(UC_CTL_CPU_MODEL, 1), UC_CPU_M68K_M68000);
  p.map_memory();
  const Address stack = kSystemRam.first + kSystemRam.size - 4;
  std::array<std::uint8_t, 4> back{};
  store_big<std::uint32_t>(back, 0, kReturnTo);
  p.library->mem_write(p.engine, stack, back.data(), back.size());
  p.set(UC_M68K_REG_SR, kSupervisor);  // before A7: it chooses which stack pointer that is
  p.set(UC_M68K_REG_A7, stack);
  p.set(UC_M68K_REG_D0, argument);
  p.set(UC_M68K_REG_PC, start);
}

UserSoftware::~UserSoftware() = default;

void UserSoftware::step(const MachineInputs& inputs, double period_s) {
  Processor& p = *processor_;
  if (p.end != UserEnd::running) return;
  store_big<std::uint32_t>(p.inputs, 0, inputs.periods);
  for (std::size_t a = 0; a < kAxes; ++a)
    store_big<std::uint32_t>(p.inputs, 4 + 4 * a, static_cast<std::uint32_t>(inputs.position_um[a]));
  store_big<std::uint32_t>(p.inputs, 16, inputs.present);
  p.allowed += static_cast<std::uint64_t>(period_s * static_cast<double>(kInstructionsPer_s));
  if (p.allowed <= p.instructions) return;
  const uc_err error = p.library->emu_start(p.engine, p.reg(UC_M68K_REG_PC), kReturnTo, 0, 0);
  p.take_back();
  if (p.end != UserEnd::running) return;
  if (p.reg(UC_M68K_REG_PC) == kReturnTo) {
    p.end = UserEnd::returned;
  } else if (error != UC_ERR_OK) {
    p.trap(fmt::format("{} at PC 0x{:06X}", p.library->strerror(error), p.pc));
  } else if (p.instructions < p.allowed) {
    p.trap(fmt::format("STOP at PC 0x{:06X}: no interrupt will end it", p.pc));
  } else if (p.instructions >= kMostInstructions) {
    p.end = UserEnd::too_long;
    p.why = fmt::format("no end after {} instructions, at PC 0x{:06X}", p.instructions, p.pc);
  }
}

void UserSoftware::host_wrote(Address first, std::uint32_t size) {
  if (processor_->engine != nullptr && kSystemRam.contains(first)) processor_->load(first, size);
}

UserEnd UserSoftware::end() const { return processor_->end; }
const std::string& UserSoftware::why() const { return processor_->why; }
std::uint64_t UserSoftware::instructions() const { return processor_->instructions; }

Registers68000 UserSoftware::registers() const {
  Registers68000 registers;
  if (processor_->engine == nullptr) return registers;
  for (std::size_t i = 0; i < 8; ++i) {
    registers.d[i] = processor_->reg(kData[i]);
    registers.a[i] = processor_->reg(kAddress[i]);
  }
  registers.pc = processor_->reg(UC_M68K_REG_PC);
  registers.sr = static_cast<std::uint16_t>(processor_->reg(UC_M68K_REG_SR));
  return registers;
}

void UserSoftware::keep_registers() {
  const Registers68000 registers = this->registers();
  std::array<std::uint8_t, kUserRegisterBytes> bytes{};
  for (std::size_t i = 0; i < 8; ++i) {
    store_big<std::uint32_t>(bytes, 4 * i, registers.d[i]);
    store_big<std::uint32_t>(bytes, 32 + 4 * i, registers.a[i]);
  }
  store_big<std::uint32_t>(bytes, 64, registers.pc);
  store_big<std::uint32_t>(bytes, 68, registers.sr);
  processor_->memory.write(kUserRegisters, bytes);
}

}  // namespace ecs::emulator
