// A certificate of what a logbook holds: the measurements since the last one, their statistics and uncertainties.
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "commissioning/certificate/dcc.hpp"
#include "commissioning/logbook/replay.hpp"

namespace ecs::commissioning {

/// What the logbook does not know.
struct CertificateWishes {
  std::string laboratory, city, customer, person;
  std::string country;  ///< of the laboratory, ISO 3166-1
  std::string schema_version = "3.3.0";
  std::vector<std::string> uncertainty;  ///< words of `laser stats`: "--instrument-um-per-m", "0.5"
  bool all = false;                      ///< every measurement, not only those since the last certificate
  bool to_be_signed = false;
};

/// @param now  "2026-05-04T09:30:00Z"  `refused` where nothing measured can be certified, with the reasons.
[[nodiscard]] Result<Certificate> certificate_of(const Logbook& book, const CertificateWishes& wishes,
                                                 const RunVerb& run, const std::string& now);

/// The certificate with its signature, by the program xmlsec1. @param key, signer  PEM files; signer may be empty
[[nodiscard]] Result<std::string> signed_by(const std::string& xml, const std::string& key, const std::string& signer);

}  // namespace ecs::commissioning
