#include <openssl/bio.h>
#include <openssl/bn.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/rand.h>
#include <openssl/sha.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <array>
#include <ctime>
#include <memory>

#include "common/runtime/result.h"
#include "keystore/keystore.h"

namespace conav::keystore {
namespace {

template <auto kFree>
struct Freed {
  template <class T>
  void operator()(T* object) const {
    kFree(object);
  }
};
using Bio = std::unique_ptr<BIO, Freed<BIO_free>>;
using Key = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using RevocationList = std::unique_ptr<X509_CRL, Freed<X509_CRL_free>>;
using Time = std::unique_ptr<ASN1_TIME, Freed<ASN1_TIME_free>>;
using Number = std::unique_ptr<BIGNUM, Freed<BN_free>>;

[[noreturn]] void Throw(const std::string& what) {
  char reason[256] = "";
  ERR_error_string_n(ERR_get_error(), reason, sizeof reason);
  throw StartupError(fmt::format("OpenSSL cannot {}: {}", what, reason));
}

void Check(bool done, const char* what) {
  if (!done) Throw(what);
}

Bio Input(const std::string& text) {
  return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

Bio Output() { return Bio(BIO_new(BIO_s_mem())); }

std::string TextOf(const Bio& bio) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &data);
  return {data, static_cast<std::size_t>(size)};
}

Certificate ReadCertificate(const std::string& text) {
  Certificate certificate(PEM_read_bio_X509(Input(text).get(), nullptr, nullptr, nullptr));
  Check(certificate != nullptr, "read a certificate");
  return certificate;
}

Key ReadKey(const std::string& text) {
  Key key(PEM_read_bio_PrivateKey(Input(text).get(), nullptr, nullptr, nullptr));
  Check(key != nullptr, "read a private key");
  return key;
}

std::string HexOf(const ASN1_INTEGER* integer) {
  const Number number(ASN1_INTEGER_to_BN(integer, nullptr));
  char* text = BN_bn2hex(number.get());
  std::string hex = text;
  OPENSSL_free(text);
  return hex;
}

void AddEntry(X509_NAME* name, const char* field, const std::string& value) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(value.data());
  Check(X509_NAME_add_entry_by_txt(name, field, MBSTRING_UTF8, bytes,
                                   static_cast<int>(value.size()), -1, 0) == 1,
        "make a name of at most 64 characters");
}

void AddExtension(X509* certificate, X509* issuer, int kind, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  X509_EXTENSION* extension = X509V3_EXT_conf_nid(nullptr, &context, kind, value);
  Check(extension != nullptr && X509_add_ext(certificate, extension, -1) == 1, "add an extension");
  X509_EXTENSION_free(extension);
}

void SetRandomSerial(X509* certificate) {
  const Number number(BN_new());
  Check(BN_rand(number.get(), 127, BN_RAND_TOP_ONE, BN_RAND_BOTTOM_ANY) == 1,
        "draw a serial number");
  BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate));
}

/// Without issuer and signature.
Certificate Draft(const std::string& common_name, const std::string& unit, EVP_PKEY* key,
                  int days) {
  Certificate certificate(X509_new());
  X509_set_version(certificate.get(), 2);  // version 3
  SetRandomSerial(certificate.get());
  X509_time_adj_ex(X509_getm_notBefore(certificate.get()), -1, 0, nullptr);
  X509_time_adj_ex(X509_getm_notAfter(certificate.get()), days, 0, nullptr);
  X509_NAME* name = X509_get_subject_name(certificate.get());
  AddEntry(name, "CN", common_name);
  if (!unit.empty()) AddEntry(name, "OU", unit);
  X509_set_pubkey(certificate.get(), key);
  return certificate;
}

Identity SignedBy(X509* certificate, EVP_PKEY* own_key, X509* issuer, EVP_PKEY* issuer_key) {
  X509_set_issuer_name(certificate, X509_get_subject_name(issuer));
  Check(X509_sign(certificate, issuer_key, EVP_sha256()) > 0, "sign a certificate");
  const Bio text = Output();
  const Bio key_text = Output();
  Check(PEM_write_bio_X509(text.get(), certificate) == 1, "write a certificate");
  Check(
      PEM_write_bio_PrivateKey(key_text.get(), own_key, nullptr, nullptr, 0, nullptr, nullptr) == 1,
      "write a private key");
  return {TextOf(text), TextOf(key_text)};
}

Key MakeKey() {
  Key key(EVP_EC_gen("P-256"));
  Check(key != nullptr, "make a key");
  return key;
}

}  // namespace

Identity MakeAuthority(const std::string& common_name, int days) {
  const Key key = MakeKey();
  const Certificate certificate = Draft(common_name, "", key.get(), days);
  AddExtension(certificate.get(), certificate.get(), NID_basic_constraints,
               "critical,CA:TRUE,pathlen:0");
  AddExtension(certificate.get(), certificate.get(), NID_key_usage,
               "critical,keyCertSign,cRLSign,digitalSignature");
  return SignedBy(certificate.get(), key.get(), certificate.get(), key.get());
}

Identity MakeIdentity(const std::string& common_name, const std::string& unit,
                      const Identity& authority, int days) {
  const Key key = MakeKey();
  const Certificate issuer = ReadCertificate(authority.certificate);
  const Certificate certificate = Draft(common_name, unit, key.get(), days);
  AddExtension(certificate.get(), issuer.get(), NID_basic_constraints, "critical,CA:FALSE");
  AddExtension(certificate.get(), issuer.get(), NID_key_usage,
               "critical,digitalSignature,keyAgreement");
  return SignedBy(certificate.get(), key.get(), issuer.get(), ReadKey(authority.key).get());
}

std::string SubjectOf(const std::string& text) {
  const Certificate certificate = ReadCertificate(text);
  const Bio name = Output();
  X509_NAME_print_ex(name.get(), X509_get_subject_name(certificate.get()), 0,
                     XN_FLAG_RFC2253 & ~ASN1_STRFLGS_ESC_MSB);
  return TextOf(name);
}

std::uint8_t SubjectHash(const std::string& text) {
  const Certificate certificate = ReadCertificate(text);
  std::array<unsigned char, SHA256_DIGEST_LENGTH> hash{};
  unsigned size = 0;
  X509_NAME_digest(X509_get_subject_name(certificate.get()), EVP_sha256(), hash.data(), &size);
  return hash[0];
}

bool IsSignedBy(const std::string& certificate, const std::string& authority) {
  const Certificate signer = ReadCertificate(authority);
  return X509_verify(ReadCertificate(certificate).get(), X509_get0_pubkey(signer.get())) == 1;
}

std::string SerialOf(const std::string& certificate) {
  return HexOf(X509_get0_serialNumber(ReadCertificate(certificate).get()));
}

std::string EndOf(const std::string& text) {
  const Certificate certificate = ReadCertificate(text);
  std::tm end{};
  Check(ASN1_TIME_to_tm(X509_get0_notAfter(certificate.get()), &end) == 1, "read a time");
  char result[32] = "";
  std::strftime(result, sizeof result, "%Y-%m-%dT%H:%M:%S", &end);
  return result;
}

std::string Sign(const std::string& text, const Identity& authority) {
  const Certificate certificate = ReadCertificate(authority.certificate);
  const int flags = PKCS7_DETACHED | PKCS7_TEXT;
  const std::unique_ptr<PKCS7, Freed<PKCS7_free>> signature(PKCS7_sign(
      certificate.get(), ReadKey(authority.key).get(), nullptr, Input(text).get(), flags));
  Check(signature != nullptr, "sign a file");
  const Bio output = Output();
  Check(SMIME_write_PKCS7(output.get(), signature.get(), Input(text).get(), flags) == 1,
        "write a signature");
  return TextOf(output);
}

std::vector<std::string> RevokedIn(const std::string& text) {
  if (text.empty()) return {};
  const RevocationList list(PEM_read_bio_X509_CRL(Input(text).get(), nullptr, nullptr, nullptr));
  Check(list != nullptr, "read a revocation list");
  std::vector<std::string> serials;
  const auto* entries = X509_CRL_get_REVOKED(list.get());
  for (int i = 0; i < sk_X509_REVOKED_num(entries); ++i) {
    serials.push_back(HexOf(X509_REVOKED_get0_serialNumber(sk_X509_REVOKED_value(entries, i))));
  }
  return serials;
}

std::string MakeRevocationList(const std::vector<std::string>& serials, const Identity& authority) {
  const Certificate issuer = ReadCertificate(authority.certificate);
  const RevocationList list(X509_CRL_new());
  X509_CRL_set_version(list.get(), 1);  // version 2
  X509_CRL_set_issuer_name(list.get(), X509_get_subject_name(issuer.get()));
  const Time start(X509_time_adj_ex(nullptr, -1, 0, nullptr));
  X509_CRL_set1_lastUpdate(list.get(), start.get());
  X509_CRL_set1_nextUpdate(list.get(), X509_get0_notAfter(issuer.get()));
  for (const std::string& serial : serials) {
    BIGNUM* parsed = nullptr;
    Check(BN_hex2bn(&parsed, serial.c_str()) > 0, "read a serial number");
    const Number number(parsed);
    const std::unique_ptr<ASN1_INTEGER, Freed<ASN1_INTEGER_free>> integer(
        BN_to_ASN1_INTEGER(number.get(), nullptr));
    X509_REVOKED* revoked = X509_REVOKED_new();
    X509_REVOKED_set_serialNumber(revoked, integer.get());
    X509_REVOKED_set_revocationDate(revoked, start.get());
    X509_CRL_add0_revoked(list.get(), revoked);
  }
  X509_CRL_sort(list.get());
  Check(X509_CRL_sign(list.get(), ReadKey(authority.key).get(), EVP_sha256()) > 0,
        "sign a revocation list");
  const Bio output = Output();
  Check(PEM_write_bio_X509_CRL(output.get(), list.get()) == 1, "write a revocation list");
  return TextOf(output);
}

}  // namespace conav::keystore
