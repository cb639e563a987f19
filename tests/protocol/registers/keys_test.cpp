// The exchange of keys against the vectors of its document, and keyed checks against another implementation.
#include "protocol/registers/keys.hpp"

#include <algorithm>
#include <charconv>
#include <numeric>

#include <fmt/format.h>

#include "base/file.hpp"
#include "core/bytes.hpp"
#include "protocol/registers/unit_registers.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::protocol;

namespace {

std::vector<std::uint8_t> octets_of(std::string_view digits) {
  std::vector<std::uint8_t> octets(digits.size() / 2);
  for (std::size_t i = 0; i < octets.size(); ++i)
    std::from_chars(digits.data() + 2 * i, digits.data() + 2 * i + 2, octets[i], 16);
  return octets;
}

template <class T>
T array_of(std::string_view digits) {
  T array{};
  std::ranges::copy(octets_of(digits), array.begin());
  return array;
}

std::string digits_of(const auto& octets) {
  std::string digits;
  for (const std::uint8_t octet : octets) digits += fmt::format("{:02x}", octet);
  return digits;
}

std::string text_of_octets(std::string_view digits) {
  const auto octets = octets_of(digits);
  return {octets.begin(), octets.end()};
}

/// draft-irtf-cfrg-cpace, "Test vector for CPace using group ristretto255 and hash SHA-512".
const ExchangeTerms kTerms{"Password", text_of_octets("0b415f696e69746961746f720b425f726573706f6e646572"),
                           text_of_octets("7e4b4791d6a8ef019b936c79fb7f2c57"), "ADa", "ADb"};
const auto kHost = array_of<Scalar>("da3d23700a9e5699258aef94dc060dfda5ebb61f02a5ea77fad53f4ff0976d08");
const auto kUnit = array_of<Scalar>("d2316b454718c35362d83d69df6320f38578ed5984651435e2949762d900b80d");
const Secret kCounting = [] {
  Secret key{};
  std::iota(key.begin(), key.end(), std::uint8_t{0});
  return key;
}();

}  // namespace

TEST_CASE("the exchange gives generator, shares and key of the published vectors") {
  CHECK(digits_of(generator_string(kTerms)) ==
        "11435061636552697374726574746f3235350850617373776f726464" + std::string(200, '0') +
            "180b415f696e69746961746f720b425f726573706f6e646572107e4b4791d6a8ef019b936c79fb7f2c57");
  const HalfExchange host = half_exchange(kTerms, kHost), unit = half_exchange(kTerms, kUnit);
  CHECK(digits_of(host.share) == "d6bac480f2c386c394efc7c47adb9925dcd2630b64f240c50f8d0eec482b9157");
  CHECK(digits_of(unit.share) == "3ea7e0b19560d7c0b0f5734f63b955286dfa8232b5ebe63324e2d9e7433f7258");
  CHECK(digits_of(multiplied(kHost, unit.share).value()) ==
        "80b69a8a76457ab6a4d7f887a4bf6b55a2f80ac19c333f917a05fc9887c8b40f");
  const SharedKey key = shared_key(kTerms, End::host, host, unit.share).value();
  CHECK(key == shared_key(kTerms, End::unit, unit, host.share).value());
  CHECK(digits_of(key) ==
        "b69effbf61b51d56401c0f65601abe428de8206feaaf0e32198896dcae7b35cd"
        "2b38950a39dfd5d4a79164614c2984f7daa460b588c1e80c3fa2068af7900447");
}

TEST_CASE("a scalar times a point is that of the published vectors, and what is no point gives nothing") {
  const auto scalar = array_of<Scalar>("7cd0e075fa7955ba52c02759a6c90dbbfc10e6d40aea8d283e407d88cf538a05");
  const auto times = [&](std::string_view point) { return multiplied(scalar, array_of<Share>(point)); };
  CHECK(digits_of(times("2c3c6b8c4f3800e7aef6864025b4ed79bd599117e427c41bd47d93d654b4a51c").value()) ==
        "7c13645fe790a468f62c39beb7388e541d8405d1ade69d1778c5fe3e7f6b600e");
  CHECK_FALSE(times("2b3c6b8c4f3800e7aef6864025b4ed79bd599117e427c41bd47d93d654b4a51c"));
  CHECK_FALSE(times(std::string(64, '0')));
  CHECK_FALSE(times(std::string(64, 'f')));
}

TEST_CASE("confirmations depend on the shared key, and those of host and unit differ") {
  const HalfExchange host = half_exchange(kTerms, kHost), unit = half_exchange(kTerms, kUnit);
  const SharedKey key = shared_key(kTerms, End::host, host, unit.share).value();
  // by tests/attacks/cpace.py, written from the documents
  CHECK(digits_of(confirmation_of(kTerms, End::host, key, host.share)) == "30478d28d83ae3b214295e91f4a3eb62");
  CHECK(digits_of(confirmation_of(kTerms, End::unit, key, unit.share)) == "e927a7da291676f8878caae9cb70407d");
  SharedKey other = key;
  other[0] ^= 1;
  CHECK_FALSE(
      same(confirmation_of(kTerms, End::host, other, host.share), confirmation_of(kTerms, End::host, key, host.share)));
}

TEST_CASE("ends that differ in code, unit, session or minutes end with different keys, and two runs as well") {
  const ExchangeTerms terms = exchange_terms("271828", "ECS-0042", 7, 30);
  const HalfExchange unit = half_exchange(terms);
  for (const ExchangeTerms& other :
       {exchange_terms("271829", "ECS-0042", 7, 30), exchange_terms("271828", "ECS-0043", 7, 30),
        exchange_terms("271828", "ECS-0042", 8, 30), exchange_terms("271828", "ECS-0042", 7, 31)}) {
    const HalfExchange host = half_exchange(other);
    CHECK(shared_key(other, End::host, host, unit.share) != shared_key(terms, End::unit, unit, host.share));
  }
  const HalfExchange host = half_exchange(terms);
  const SharedKey key = shared_key(terms, End::host, host, unit.share).value();
  CHECK(key == shared_key(terms, End::unit, unit, host.share).value());
  CHECK(half_exchange(terms).share != host.share);
}

TEST_CASE(
    "secrets and keyed checks are those of another implementation") {  // tests/attacks/cpace.py, by Python's hashlib
  SharedKey counting{};
  std::iota(counting.begin(), counting.end(), std::uint8_t{0});
  CHECK(digits_of(secret_from(counting)) == "c6117d782bd189eff59fc631eb768ed3ca10d4a370018abf7f08d3f6873efa5e");
  CHECK(digits_of(session_key(kCounting, 0x12345678, 0x0123456789ABCDEF)) ==
        "99688464a1077e3f258b9c78fdbf61cb76655a3774876323b9078ec897a121e9");
  const WindowOpen window{0x34353637, 0x100000, 1000, 0xA1B2C3D4, false, {0x30313233, 99}};
  CHECK(block_check(kCounting, window, 7, octets_of("39")) == 0x3ce9e4f13ea65fd9);
  CHECK(piece_check(kCounting, 0x100100, octets_of("616263")) == 0x1fe384a1ce66d2d1);
  CHECK(keyed_check(std::nullopt, Keyed::command, Registers{1, 2}) == 0x0c14c132bbba1344);
}

TEST_CASE("a sealed block agrees with its key, whatever its echo, and with nothing else") {
  Registers block = sealed(registers_of(Command{.code = CommandCode::clear_fault}, 5), Keyed::command, kCounting);
  block[0] = 77;
  CHECK(seal_agrees(block, Keyed::command, kCounting));
  CHECK_FALSE(seal_agrees(block, Keyed::window, kCounting));
  CHECK_FALSE(seal_agrees(block, Keyed::command, std::nullopt));
  for (std::size_t i = 1; i < block.size(); ++i) {
    Registers flipped = block;
    flipped[i] ^= 0x0100;
    CHECK_FALSE(seal_agrees(flipped, Keyed::command, kCounting));
  }
}

TEST_CASE("the documentation shows a worked exchange, and it is what this program computes") {
  const auto document = must(read_file("docs/protocol.md"));
  const auto shown = [&](const std::string& digits) { CHECK_MESSAGE(contains(document, "`" + digits + "`"), digits); };
  constexpr std::uint32_t kSessionNumber = 0x0A0B0C0D;
  const ExchangeTerms terms = exchange_terms("271828", "ECS-0042", kSessionNumber, 30);
  const auto of_host = array_of<Scalar>("275a174ad03fe2575cd01bc64f1a51e61012131415161718191a1b1c1d1e1f00");
  const auto of_unit = array_of<Scalar>("6dd24bb0bb99ddc7cfb64ca0b246b3dc3032333435363738393a3b3c3d3e3f00");
  const HalfExchange host = half_exchange(terms, of_host), unit = half_exchange(terms, of_unit);
  const SharedKey key = shared_key(terms, End::host, host, unit.share).value();
  const Secret secret = secret_from(key), session = session_key(secret, kSessionNumber, 0x1122334455667788);
  shown(digits_of(of_host));
  shown(digits_of(of_unit));
  shown(digits_of(half_exchange(terms, Scalar{1}).share));  // the generator
  shown(digits_of(host.share));
  shown(digits_of(unit.share));
  shown(digits_of(confirmation_of(terms, End::host, key, host.share)));
  shown(digits_of(confirmation_of(terms, End::unit, key, unit.share)));
  shown(digits_of(secret));
  shown(digits_of(session));
  const auto check = [&](const Registers& block) { return fmt::format("{:016x}", check_at_end(block)); };
  const Command begin{.sequence = 1,
                      .code = CommandCode::begin_staging,
                      .staging_from = StagingFrom::kept,
                      .asker = {kSessionNumber, 5},
                      .clock_ms = 0xABCD};
  shown(check(sealed(registers_of(begin, 0), Keyed::command, session)));
  const WindowOpen window{1, 0x100000, 4, 0xA1B2C3D4, false, {kSessionNumber, 6}};
  shown(check(sealed(registers_of(window, 0), Keyed::window, session)));
  const std::vector<std::uint8_t> bytes{1, 2, 3, 4};
  shown(fmt::format("{:016x}", block_check(session, window, 0, bytes)));
  const Registers ack = registers_of(WindowAck{1, UnitError::none, 0x100000, 4, 1, 0xB63CFBCD}, 0x1234);
  shown(fmt::format("{:016x}", answer_check(session, kWindowAck, 6, ack)));
  shown(fmt::format("{:016x}", piece_check(session, 0x100000, bytes)));
}
