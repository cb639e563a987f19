// How a report looks: on a screen, light or dark, and on A4.
#pragma once

#include <string>

namespace ecs::app {

/// The text at the edge of every printed page.
struct PageEdges {
  std::string top_left;
  std::string top_right;
  std::string bottom_left;
};

/// The style sheet; names nothing outside the page.
[[nodiscard]] std::string report_style(const PageEdges& edges);

}  // namespace ecs::app
