#pragma once

#include <cstdint>
#include <string>
#include <vector>

/// X.509 certificates, signatures and revocation lists as DDS security wants them, by OpenSSL: ECDSA on
/// P-256 with SHA-256, all texts PEM. Pure. Errors: StartupError with OpenSSL's reason.
namespace conav::keystore {

struct Identity {
  std::string certificate;
  std::string key;
};

/// Certificates count from a day before now, since the clocks of hosts differ.
Identity MakeAuthority(const std::string& common_name, int days);

/// A certificate of `common_name`, with `unit` as OU, by `authority`.
Identity MakeIdentity(const std::string& common_name, const std::string& unit,
                      const Identity& authority, int days);

/// "OU=2,CN=/conav/host/sim/cyclonedds": the subject as permissions name it (RFC 2253).
std::string SubjectOf(const std::string& certificate);

/// The first byte of the SHA-256 of the subject in DER. Both DDS vendors derive the participant's GUID
/// from it.
std::uint8_t SubjectHash(const std::string& certificate);

/// Hexadecimal.
std::string SerialOf(const std::string& certificate);

/// The time of its end, "2036-11-24T00:00:00" UTC.
std::string EndOf(const std::string& certificate);

/// `text` with its detached S/MIME signature, as governance and permissions are sent.
std::string Sign(const std::string& text, const Identity& authority);

/// The serials of `list`, which may be empty.
std::vector<std::string> RevokedIn(const std::string& list);

/// The revocation list of these serials. It has no end of its own before that of the authority: a list that
/// runs out would stop all.
std::string MakeRevocationList(const std::vector<std::string>& serials, const Identity& authority);

}  // namespace conav::keystore
