// An image that is called verified has the values that were sent, whatever its checks say.
#include "commissioning/unit/transfer.hpp"
#include "core/memory_image.hpp"
#include "laser/map/image.hpp"
#include "tests/support/test.hpp"
#include "tests/support/unit_model.hpp"

namespace ecs::commissioning {
namespace {

using protocol::forge;
using protocol::ModbusServer;
using protocol::UnitModel;
using protocol::Workshop;
using Bytes = std::vector<std::uint8_t>;

/// A place where that changes a value and leaves a sound image.
std::size_t place_in(const Bytes& image) {
  std::size_t at = kPrefixBytes;
  for (Bytes changed = image; at + 5 < image.size(); ++at, changed = image) {
    forge(changed, at);
    if (check_image(changed).fault == ImageFault::none) break;
  }
  return at;
}

Bytes active_in(Workshop& shop) {
  return shop.in_server([](ModbusServer&, UnitModel& model) { return model.active_image(); });
}

/// The image of these parameters as that unit holds it.
Bytes sent_to(Workshop& shop) {
  auto unit = shop.client();
  CHECK_FALSE(must(send_image(unit, laser::image_of(UnitParameters{}))).already_held);
  return active_in(shop);
}

TEST_CASE("an image is held already only if its values are the same") {
  auto shop = Workshop::on_tcp();
  const Bytes image = sent_to(shop);
  auto unit = shop.client();
  CHECK(send_image(unit, image)->already_held);
  shop.in_server([at = place_in(image)](ModbusServer&, UnitModel& model) {
    forge(model.active == protocol::Bank::A ? model.bank_a : model.bank_b, at);
  });
  const Bytes forged = active_in(shop);
  REQUIRE(forged != image);
  REQUIRE(check_image(forged).fault == ImageFault::none);
  const auto sent = must(send_image(unit, image));
  CHECK_FALSE(sent.already_held);
  CHECK(sent.bytes_sent < image.size());  // the pieces that differ
  CHECK(active_in(shop) == image);
}

TEST_CASE("an image that the other bank still contains is made active without a byte sent") {
  auto shop = Workshop::on_tcp();
  const Bytes first = sent_to(shop);
  auto unit = shop.client();
  UnitParameters other;
  other.axes[0].position_loop_gain_per_s += 1.0;
  CHECK_FALSE(must(send_image(unit, laser::image_of(other), Addressee::this_unit)).was_in_other_bank());
  CHECK(must(send_image(unit, first)).was_in_other_bank());
  CHECK_FALSE(must(send_image(unit, first)).was_in_other_bank());  // which is active now
}

TEST_CASE("an image whose values change although its checks agree is not called verified") {
  auto shop = Workshop::on_tcp();
  shop.in_server([at = place_in(sent_to(shop))](ModbusServer&, UnitModel& model) {
    model.after_commit = [&model, at] { forge(model.active == protocol::Bank::A ? model.bank_a : model.bank_b, at); };
  });
  UnitParameters other;
  other.axes[0].position_loop_gain_per_s += 1.0;
  auto unit = shop.client();
  const auto sent = must_fail(send_image(unit, laser::image_of(other), Addressee::this_unit));
  check_holds(sent.message, {"the active map has changed", "compare before compensating"});
}

TEST_CASE("an image whose values change after they were read back is not called already held, and is sent whole") {
  auto shop = Workshop::on_tcp();
  const Bytes image = sent_to(shop);
  auto unit = shop.client();
  bool changed = false;
  const auto sent = must(send_image(unit, image, Addressee::as_stated, [&](const protocol::Progress& now) {
    if (now.bytes_done == now.bytes_total || std::exchange(changed, true)) return;
    shop.in_server([](ModbusServer&, UnitModel& model) {  // of the piece that was read first
      (model.active == protocol::Bank::A ? model.bank_a : model.bank_b)[kPrefixBytes] ^= 1;
    });
  }));
  CHECK(changed);
  CHECK_FALSE(sent.already_held);
  CHECK(active_in(shop) == image);
}

TEST_CASE("a map that another host sends before the values are compared is left as it is") {
  auto shop = Workshop::on_tcp();
  (void)sent_to(shop);
  UnitParameters other;
  other.axes[0].position_loop_gain_per_s += 1.0;
  auto unit = shop.client();
  bool all_sent = false, happened = false;
  const auto sent =
      must_fail(send_image(unit, laser::image_of(other), Addressee::this_unit, [&](const protocol::Progress& now) {
        all_sent = all_sent || now.bytes_done == now.bytes_total;
        const bool reads_back = all_sent && now.bytes_done < now.bytes_total;
        if (!reads_back || std::exchange(happened, true)) return;
        shop.in_server([](ModbusServer&, UnitModel& model) { model.switch_banks(model.image_length); });
      }));
  CHECK(contains(sent.message, "another map is now active (commit no. 3)"));
  CHECK(shop.in_server([](ModbusServer&, UnitModel& model) { return model.commits; }) == 3);
}

TEST_CASE("parameters for a unit whose image is damaged are refused as such, with a remedy that every verb has") {
  auto shop = Workshop::on_tcp();
  (void)sent_to(shop);
  shop.in_server([](ModbusServer&, UnitModel& model) {
    (model.active == protocol::Bank::A ? model.bank_a : model.bank_b)[kPrefixBytes] ^= 1;
  });
  auto unit = shop.client();
  const Problem why = must_fail(send_parameters(unit, UnitParameters{}, {}));
  check_holds(why.message,
              {"contains no valid map", "`ecs map send MAP --params FILE`", "`ecs params send FILE --force`"});
  CHECK(send_parameters(unit, UnitParameters{}, {}, UnfitMap::drop)->map_dropped);
}

}  // namespace
}  // namespace ecs::commissioning
