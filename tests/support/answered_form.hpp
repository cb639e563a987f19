// A form whose verb has answered.
#pragma once

#include <chrono>
#include <thread>

#include "app/screens/forms/rows.hpp"
#include "tests/support/screen_driver.hpp"

namespace ecs::app::screen_test {

/// Run at once, until it has answered.
inline std::unique_ptr<Screen> answered(const std::string& title, const FormValues& values) {
  auto screen = form_titled(title, no_link(), values, true);
  REQUIRE(screen);
  while (screen->advance()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return screen;
}

}  // namespace ecs::app::screen_test
