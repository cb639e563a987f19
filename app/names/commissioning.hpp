// The program speaks of what commissioning/ defines by its own names.
#pragma once

namespace ecs::commissioning {}

namespace ecs::app {
using namespace commissioning;
}
