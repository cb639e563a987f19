// A report as one HTML page: no scripts, nothing fetched from anywhere, A4 on paper.
// Does not live here: what it tells (report_content.hpp, report_judgement.hpp), writing the file (report_verb.cpp).
#pragma once

#include <string>

#include "app/report_content.hpp"
#include "app/report_judgement.hpp"

namespace ecs::app {

[[nodiscard]] std::string report_page(const ReportContent& content, const Judgement& judgement);

}  // namespace ecs::app
