#include "tests/kinematics/support/linuxcnc_kinematics.hpp"

#include <cstdarg>
#include <cstdio>
#include <map>
#include <memory>
#include <vector>

#include <dlfcn.h>

namespace {

constexpr const char* kFolder = "/usr/lib/linuxcnc/modules/";

/// Pins and memory of the modules, for as long as the program runs.
struct Hal {
  std::map<std::string, double> number;
  std::vector<std::unique_ptr<std::vector<double>>> memory;
  void* room(std::size_t bytes) {
    memory.push_back(std::make_unique<std::vector<double>>(bytes / sizeof(double) + 1));
    return memory.back()->data();
  }
};
Hal& hal() {
  static Hal one;
  return one;
}

std::string formatted(const char* format, va_list words) {
  std::array<char, 256> text{};
  std::vsnprintf(text.data(), text.size(), format, words);
  return text.data();
}

/// As LinuxCNC's EmcPose: tran, a, b, c, u, v, w.
struct EmcPose {
  double x, y, z, a, b, c, u, v, w;
};

template <class Function>
Function function_in(void* module, const char* name) {
  return reinterpret_cast<Function>(dlsym(module, name));
}

}  // namespace

// What the modules import from HAL and RTAPI (hal.h, rtapi.h of LinuxCNC 2.9).
extern "C" {
int hal_init(const char*) { return 1; }
int hal_ready(int) { return 0; }
int hal_set_unready(int) { return 0; }
int hal_exit(int) { return 0; }
void* hal_malloc(long bytes) { return hal().room(static_cast<std::size_t>(bytes)); }
int hal_pin_float_new(const char* name, int, double** pin, int) {
  *pin = &hal().number[name];
  return 0;
}
int hal_pin_float_newf(int, double** pin, int, const char* format, ...) {
  va_list words;
  va_start(words, format);
  *pin = &hal().number[formatted(format, words)];
  va_end(words);
  return 0;
}
int hal_pin_bit_new(const char*, int, void** pin, int) {
  *pin = hal().room(sizeof(double));
  return 0;
}
int hal_pin_s32_new(const char*, int, void** pin, int) {
  *pin = hal().room(sizeof(double));
  return 0;
}
int hal_pin_s32_newf(int, void** pin, int, const char*, ...) {
  *pin = hal().room(sizeof(double));
  return 0;
}
void rtapi_print(const char*, ...) {}
void rtapi_print_msg(int, const char*, ...) {}
int rtapi_snprintf(char* out, unsigned long size, const char* format, ...) {
  va_list words;
  va_start(words, format);
  const int length = std::vsnprintf(out, size, format, words);
  va_end(words);
  return length;
}
}

namespace ecs::test {

std::optional<LinuxcncKinematics> LinuxcncKinematics::load(const std::string& module) {
  LinuxcncKinematics loaded;
  loaded.module_ = dlopen((kFolder + module + ".so").c_str(), RTLD_NOW | RTLD_LOCAL);
  if (loaded.module_ == nullptr) return std::nullopt;
  loaded.name_ = module;
  const auto main = function_in<int (*)()>(loaded.module_, "rtapi_app_main");
  const auto type = function_in<int (*)()>(loaded.module_, "kinematicsType");  // some make their pins here
  if (main == nullptr || type == nullptr || main() != 0) return std::nullopt;
  type();
  return loaded;
}

bool LinuxcncKinematics::set(const std::string& pin, double value) const {
  const auto found = hal().number.find(name_ + "." + pin);
  if (found == hal().number.end()) return false;
  found->second = value;
  return true;
}

void LinuxcncKinematics::switch_to(int type) const { function_in<int (*)(int)>(module_, "kinematicsSwitch")(type); }

LinuxcncPose LinuxcncKinematics::forward(const std::array<double, 9>& joints) const {
  const auto forward =
      function_in<int (*)(const double*, EmcPose*, const unsigned long*, unsigned long*)>(module_, "kinematicsForward");
  std::array<double, 16> all{};
  std::copy(joints.begin(), joints.end(), all.begin());
  EmcPose pose{};
  const unsigned long how = 0;
  unsigned long way = 0;
  forward(all.data(), &pose, &how, &way);
  return {{pose.x, pose.y, pose.z}, {pose.a, pose.b, pose.c}};
}

}  // namespace ecs::test
