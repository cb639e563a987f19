// What makes a host armed and keeps others from speaking in its name: a password-authenticated key exchange, CPace on
// ristretto255 with SHA-512 (CPACE-RISTR255-SHA512, draft-irtf-cfrg-cpace), whose password is the code that the unit
// shows, and keyed checks under the secret that both ends derive from it. Groups and hashes are those of libsodium.
// Does not live here: which registers carry them (unit_registers.hpp), who is armed
// (protocol/server/host_sessions.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ecs::protocol {

using Scalar = std::array<std::uint8_t, 32>;        ///< little-endian
using Share = std::array<std::uint8_t, 32>;         ///< a point of ristretto255, encoded (RFC 9496)
using SharedKey = std::array<std::uint8_t, 64>;     ///< "ISK" of the draft
using Confirmation = std::array<std::uint8_t, 16>;  ///< 128 bits of an HMAC-SHA-512
using Secret = std::array<std::uint8_t, 32>;

/// What both ends of one exchange must agree on; whatever differs, they end with different keys.
struct ExchangeTerms {
  std::string code;       ///< "PRS": what the unit shows; empty where it shows none
  std::string channel;    ///< "CI": who talks to whom
  std::string session;    ///< "sid"
  std::string host_data;  ///< "ADa": sent beside the host's share
  std::string unit_data;  ///< "ADb": sent beside the unit's share
};

/// The bytes that are hashed to the generator (draft, "Common function for computing generators").
[[nodiscard]] std::vector<std::uint8_t> generator_string(const ExchangeTerms& terms);
/// One end's secret scalar with the share that it sends. @param scalar  by chance if left out
struct HalfExchange {
  Scalar scalar{};
  Share share{};
};
[[nodiscard]] HalfExchange half_exchange(const ExchangeTerms& terms, std::optional<Scalar> scalar = std::nullopt);

/// scalar times point. Nothing for what is no point, and for the neutral element.
[[nodiscard]] std::optional<Share> multiplied(const Scalar& scalar, const Share& point);

enum class End { host, unit };
/// From the own half and both shares as they travelled. Nothing where the other's share is no point or the neutral
/// element: the exchange ends, nothing is sent.
[[nodiscard]] std::optional<SharedKey> shared_key(const ExchangeTerms& terms, End own, const HalfExchange& half,
                                                  const Share& other);
/// By which an end shows that it has the key: HMAC-SHA-512 over its own share and data (draft, "Key confirmation"),
/// cut to 128 bits.
[[nodiscard]] Confirmation confirmation_of(const ExchangeTerms& terms, End end, const SharedKey& key,
                                           const Share& its_share);
/// In constant time.
[[nodiscard]] bool same(const Confirmation& a, const Confirmation& b);

/// What an armed host and the unit share from then on.
[[nodiscard]] Secret secret_from(const SharedKey& key);
/// The key of one session of that host. @param nonce  that the unit has drawn for the session
[[nodiscard]] Secret session_key(const Secret& secret, std::uint32_t session, std::uint64_t nonce);

/// What is checked; a check of one kind is none of another.
enum class Keyed : std::uint8_t { window = 1, block = 2, command = 3, answer = 4, piece = 5 };
/// The first 8 bytes of BLAKE2b-256 under the key over kind, the registers (high byte first) and the bytes.
/// Null key: everybody's, of zeros. Such a check finds noise, it proves nothing.
[[nodiscard]] std::uint64_t keyed_check(const std::optional<Secret>& key, Keyed kind,
                                        std::span<const std::uint16_t> registers,
                                        std::span<const std::uint8_t> bytes = {});

using ImageDigest = std::array<std::uint8_t, 32>;  ///< SHA-256
[[nodiscard]] ImageDigest digest_of(std::span<const std::uint8_t> image);
/// Its first 8 bytes.
[[nodiscard]] std::uint64_t short_digest(const ImageDigest& digest);

/// A code of six digits by chance.
[[nodiscard]] std::string code_by_chance();
/// Not 0, from the system's source of chance.
[[nodiscard]] std::uint64_t chance_64();
/// All of `out`, from the system's source of chance.
void fill_by_chance(std::span<std::uint8_t> out);

}  // namespace ecs::protocol
