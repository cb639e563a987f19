#include "app/ui/screen.hpp"

namespace ecs::app {

Step stay() { return {}; }
Step back() { return {Step::Kind::back, nullptr}; }
Step opened(std::unique_ptr<Screen> next) { return {Step::Kind::open, std::move(next)}; }

}  // namespace ecs::app
