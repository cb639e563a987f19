// The main of every test program. An entry of CTest runs the cases of one file: it fails where there is none, and is
// skipped (77) where one of them cannot run here.
#define DOCTEST_CONFIG_IMPLEMENT
#include <cstdio>

#include "tests/support/test.hpp"

namespace {

unsigned cases_run = 0;
unsigned cases_skipped = 0;

/// Keeps how many cases the filters let through.
struct CaseCount : doctest::IReporter {
  explicit CaseCount(const doctest::ContextOptions&) {}
  void report_query(const doctest::QueryData&) override {}
  void test_run_start() override {}
  void test_run_end(const doctest::TestRunStats& run) override { cases_run = run.numTestCasesPassingFilters; }
  void test_case_start(const doctest::TestCaseData&) override {}
  void test_case_reenter(const doctest::TestCaseData&) override {}
  void test_case_end(const doctest::CurrentTestCaseStats&) override {}
  void test_case_exception(const doctest::TestCaseException&) override {}
  void subcase_start(const doctest::SubcaseSignature&) override {}
  void subcase_end() override {}
  void log_assert(const doctest::AssertData&) override {}
  void log_message(const doctest::MessageData&) override {}
  void test_case_skipped(const doctest::TestCaseData&) override {}
};
REGISTER_LISTENER("case count", 1, CaseCount);

}  // namespace

void ecs::test::note_skipped(const char* file, int line, const std::string& reason) {
  ++cases_skipped;
  std::printf("%s:%d: skipped: %s\n", file, line, reason.c_str());
}

int main(int argc, char** argv) {
  doctest::Context context(argc, argv);
  const int result = context.run();
  if (context.shouldExit() || result != 0) return result;
  if (cases_run == 0) {
    std::puts("no test case to run");
    return 1;
  }
  return cases_skipped > 0 ? 77 : 0;
}
