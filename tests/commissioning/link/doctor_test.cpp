// Why a link does not work, against a small unit on a real connection.
#include "commissioning/link/doctor.hpp"

#include "tests/support/test.hpp"
#include "tests/support/unit_model.hpp"

namespace ecs::commissioning {
namespace {

LinkChoice choice_of(const protocol::LinkAddress& address) { return {address, "--link"}; }

Diagnosis examined(const LinkChoice& choice, std::vector<DoctorFinding>* reported = nullptr) {
  return diagnosis_of(
      choice, [](const std::string&) {},
      [reported](const DoctorFinding& finding) {
        if (reported != nullptr) reported->push_back(finding);
      });
}

const DoctorFinding* finding(const Diagnosis& diagnosis, std::string_view check) {
  for (const DoctorFinding& one : diagnosis.findings)
    if (one.check == check) return &one;
  return nullptr;
}

}  // namespace

TEST_CASE("a unit that answers is named, and every finding is reported as soon as it is made") {
  auto shop = protocol::Workshop::on_tcp();
  std::vector<DoctorFinding> reported;
  const Diagnosis diagnosis = examined(choice_of(shop.address()), &reported);
  CHECK(diagnosis.works);
  REQUIRE(diagnosis.identity);
  CHECK(diagnosis.identity->serial_number == "ECS-0042");
  CHECK(reported.size() == diagnosis.findings.size());
  REQUIRE(finding(diagnosis, "link"));
  CHECK(finding(diagnosis, "link")->state == FindingState::ok);
  REQUIRE(finding(diagnosis, "line"));
  CHECK(finding(diagnosis, "line")->message.starts_with("20 of 20 reads answered"));
  REQUIRE(finding(diagnosis, "battery"));
  CHECK(finding(diagnosis, "battery")->message == "good, 0.0 days old");
  CHECK(finding(diagnosis, "control") == nullptr);  // no wire says it
  CHECK(diagnosis.statistics.timeouts == 0);
}

TEST_CASE("where another unit number answers, nobody is sent to the cable because the given one is silent") {
  auto shop = protocol::Workshop::on_pty();
  protocol::LinkAddress address = shop.address();
  address.unit = 2;
  const Diagnosis diagnosis = examined(choice_of(address));
  REQUIRE(finding(diagnosis, "unit number"));
  CHECK(finding(diagnosis, "unit number")->message == "unit 1 answers, unit 2 does not");
  CHECK(finding(diagnosis, "silence") == nullptr);
}

TEST_CASE("the doctor only reads: the unit is given no command") {
  auto shop = protocol::Workshop::on_tcp();
  CHECK(examined(choice_of(shop.address())).works);
  CHECK(shop.in_server([](protocol::ModbusServer&, protocol::UnitModel& model) { return model.log; }).empty());
}

TEST_CASE("answers to another host's requests are reported as such, not as late ones, and the advice is to end it") {
  for (const int replies : {1, 1000}) {
    CAPTURE(replies);
    auto shop = protocol::Workshop::on_tcp();
    shop.in_server(
        [=](protocol::ModbusServer&, protocol::UnitModel& model) { return model.foreign_replies = replies; });
    const Diagnosis diagnosis = examined(choice_of(shop.address()));
    CHECK(diagnosis.works == (replies == 1));
    CHECK(finding(diagnosis, "late answers") == nullptr);
    const DoctorFinding* found = finding(diagnosis, replies == 1 ? "another host" : "link");
    REQUIRE(found);
    CHECK(found->state == FindingState::problem);
    CHECK(contains((found->message + found->action), "end the other program"));
  }
}

TEST_CASE("an examination that is cancelled ends without a working link") {
  auto shop = protocol::Workshop::on_tcp();
  const std::atomic<bool> cancelled{true};
  const Diagnosis diagnosis = diagnosis_of(
      choice_of(shop.address()), [](const std::string&) {}, {}, cancelled);
  CHECK_FALSE(diagnosis.works);
}

TEST_CASE("a link that returns what is sent is recognised as an echo") {
  const PortAnswer silence{{1, 2, 3}, {}};
  const PortAnswer echo{{1, 2, 3}, {1, 2, 3, 9}};
  const PortAnswer other{{1, 2, 3}, {1, 2, 4}};
  CHECK_FALSE(silence.is_echo());
  CHECK(echo.is_echo());
  CHECK_FALSE(other.is_echo());
}

}  // namespace ecs::commissioning
