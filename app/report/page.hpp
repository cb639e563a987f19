// A report as one HTML page: no scripts, nothing fetched from anywhere, A4 on paper.
// Does not live here: what it tells (content.hpp, judgement.hpp), writing the file (app/verbs/report.cpp).
#pragma once

#include <string>

#include "app/report/content.hpp"
#include "app/report/judgement.hpp"

namespace ecs::app {

[[nodiscard]] std::string report_page(const ReportContent& content, const Judgement& judgement);

}  // namespace ecs::app
