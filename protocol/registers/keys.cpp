#include "protocol/registers/keys.hpp"

#include <algorithm>
#include <initializer_list>

#include <fmt/format.h>
#include <sodium.h>

#include "core/bytes.hpp"

namespace ecs::protocol {
namespace {

using Octets = std::vector<std::uint8_t>;

constexpr std::string_view kDomain = "CPaceRistretto255";
constexpr std::string_view kKeyDomain = "CPaceRistretto255_ISK";
constexpr std::string_view kConfirmationDomain = "CPaceMac";
constexpr std::string_view kSecretDomain = "ECS secret of an armed host";
constexpr std::string_view kSessionDomain = "ECS session";
constexpr std::size_t kHashBlock = 128;  ///< of SHA-512

/// libsodium, ready for use from any thread.
bool ready() {
  static const bool done = sodium_init() >= 0;
  return done;
}

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

void append(Octets& out, std::span<const std::uint8_t> bytes) { out.insert(out.end(), bytes.begin(), bytes.end()); }

/// The length (LEB128), then the bytes: "prepend_len" of the draft.
void append_with_length(Octets& out, std::span<const std::uint8_t> bytes) {
  std::size_t length = bytes.size();
  for (; length >= 0x80; length >>= 7) out.push_back(static_cast<std::uint8_t>(length | 0x80));
  out.push_back(static_cast<std::uint8_t>(length));
  append(out, bytes);
}

Octets with_lengths(std::initializer_list<std::span<const std::uint8_t>> parts) {
  Octets out;
  for (const auto& part : parts) append_with_length(out, part);
  return out;
}

std::array<std::uint8_t, crypto_hash_sha512_BYTES> sha512_of(const Octets& bytes) {
  std::array<std::uint8_t, crypto_hash_sha512_BYTES> hash{};
  crypto_hash_sha512(hash.data(), bytes.data(), bytes.size());
  return hash;
}

}  // namespace

std::vector<std::uint8_t> generator_string(const ExchangeTerms& terms) {
  Octets head = with_lengths({bytes_of(kDomain), bytes_of(terms.code)});
  const Octets padding(head.size() + 1 < kHashBlock ? kHashBlock - head.size() - 1 : 0);
  append_with_length(head, padding);
  append_with_length(head, bytes_of(terms.channel));
  append_with_length(head, bytes_of(terms.session));
  return head;
}

HalfExchange half_exchange(const ExchangeTerms& terms, std::optional<Scalar> scalar) {
  HalfExchange half;
  if (!ready()) return half;
  Share generator{};
  crypto_core_ristretto255_from_hash(generator.data(), sha512_of(generator_string(terms)).data());
  if (scalar)
    half.scalar = *scalar;
  else
    crypto_core_ristretto255_scalar_random(half.scalar.data());
  half.share = multiplied(half.scalar, generator).value_or(Share{});
  return half;
}

std::optional<Share> multiplied(const Scalar& scalar, const Share& point) {
  Share product{};
  const bool made = ready() && crypto_scalarmult_ristretto255(product.data(), scalar.data(), point.data()) == 0;
  return made ? std::optional(product) : std::nullopt;
}

std::optional<SharedKey> shared_key(const ExchangeTerms& terms, End own, const HalfExchange& half, const Share& other) {
  const auto point = multiplied(half.scalar, other);
  if (!point) return std::nullopt;
  const Share& hosts = own == End::host ? half.share : other;
  const Share& units = own == End::host ? other : half.share;
  Octets all = with_lengths({bytes_of(kKeyDomain), bytes_of(terms.session), *point});
  append(all, with_lengths({hosts, bytes_of(terms.host_data), units, bytes_of(terms.unit_data)}));
  return sha512_of(all);
}

Confirmation confirmation_of(const ExchangeTerms& terms, End end, const SharedKey& key, const Share& its_share) {
  Octets of_key;
  for (const auto& part : {bytes_of(kConfirmationDomain), bytes_of(terms.session)}) append(of_key, part);
  append(of_key, key);
  const auto mac_key = sha512_of(of_key);
  const Octets sent = with_lengths({its_share, bytes_of(end == End::host ? terms.host_data : terms.unit_data)});
  std::array<std::uint8_t, crypto_auth_hmacsha512_BYTES> mac{};
  crypto_auth_hmacsha512_state state{};
  crypto_auth_hmacsha512_init(&state, mac_key.data(), mac_key.size());
  crypto_auth_hmacsha512_update(&state, sent.data(), sent.size());
  crypto_auth_hmacsha512_final(&state, mac.data());
  Confirmation cut{};
  std::copy_n(mac.begin(), cut.size(), cut.begin());
  return cut;
}

bool same(const Confirmation& a, const Confirmation& b) { return sodium_memcmp(a.data(), b.data(), a.size()) == 0; }

Secret secret_from(const SharedKey& key) {
  Secret secret{};
  crypto_generichash(secret.data(), secret.size(), bytes_of(kSecretDomain).data(), kSecretDomain.size(), key.data(),
                     key.size());
  return secret;
}

Secret session_key(const Secret& secret, std::uint32_t session, std::uint64_t nonce) {
  Octets terms(12);
  store_big(terms, 0, session);
  store_big(terms, 4, nonce);
  append(terms, bytes_of(kSessionDomain));
  Secret key{};
  crypto_generichash(key.data(), key.size(), terms.data(), terms.size(), secret.data(), secret.size());
  return key;
}

std::uint64_t keyed_check(const std::optional<Secret>& key, Keyed kind, std::span<const std::uint16_t> registers,
                          std::span<const std::uint8_t> bytes) {
  const Secret of_all = key.value_or(Secret{});
  Octets content(1 + 2 * registers.size());
  content[0] = static_cast<std::uint8_t>(kind);
  for (std::size_t i = 0; i < registers.size(); ++i) store_big(content, 1 + 2 * i, registers[i]);
  append(content, bytes);
  Secret hash{};
  crypto_generichash(hash.data(), hash.size(), content.data(), content.size(), of_all.data(), of_all.size());
  return load_big<std::uint64_t>(hash, 0);
}

ImageDigest digest_of(std::span<const std::uint8_t> image) {
  ImageDigest digest{};
  crypto_hash_sha256(digest.data(), image.data(), image.size());
  return digest;
}

std::uint64_t short_digest(const ImageDigest& digest) { return load_big<std::uint64_t>(digest, 0); }

void fill_by_chance(std::span<std::uint8_t> out) {
  if (ready()) randombytes_buf(out.data(), out.size());
}

std::uint64_t chance_64() {
  std::array<std::uint8_t, 8> bytes{};
  std::uint64_t number = 0;
  while (number == 0) {
    fill_by_chance(bytes);
    number = load_big<std::uint64_t>(bytes, 0);
  }
  return number;
}

std::string code_by_chance() {
  constexpr std::uint32_t kCodes = 1'000'000;
  return fmt::format("{:06}", ready() ? randombytes_uniform(kCodes) : 0);
}

}  // namespace ecs::protocol
