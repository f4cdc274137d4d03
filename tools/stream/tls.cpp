#include "tls.h"

#include "dump/error.h"
#include "dump/text.h"
#include "secrets.h"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <array>
#include <cstring>

namespace gicodec::streaming {
namespace {

using tools::Exit;
using tools::fail;

constexpr std::size_t kPinBytes = 32;

/// The reason of OpenSSL's first error; clears the others.
std::string last_error() {
  const unsigned long code = ERR_get_error();
  ERR_clear_error();
  if (ERR_SYSTEM_ERROR(code)) return std::strerror(ERR_GET_REASON(code));
  const char* const reason = ERR_reason_error_string(code);
  return reason == nullptr ? "unknown error" : reason;
}

TlsContext new_context() {
  TlsContext context(SSL_CTX_new(TLS_method()), SSL_CTX_free);
  if (!context) throw std::bad_alloc();
  return context;
}

std::string digest_of(X509* certificate) {
  std::array<unsigned char, kPinBytes> digest{};
  unsigned size = 0;
  if (X509_digest(certificate, EVP_sha256(), digest.data(), &size) != 1 || size != kPinBytes)
    return {};
  return {reinterpret_cast<const char*>(digest.data()), digest.size()};
}

/// True for errors that only mean that no authority vouches for the certificate.
bool lacks_authority(int error) {
  switch (error) {
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT:
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT_LOCALLY:
    case X509_V_ERR_UNABLE_TO_VERIFY_LEAF_SIGNATURE:
    case X509_V_ERR_DEPTH_ZERO_SELF_SIGNED_CERT:
    case X509_V_ERR_SELF_SIGNED_CERT_IN_CHAIN:
    case X509_V_ERR_CERT_UNTRUSTED:
      return true;
    default:
      return false;
  }
}

std::string explain(int error) {
  if (lacks_authority(error)) {
    return "its certificate was not issued by an authority that is trusted here: --ca names "
           "another, --pin the certificate itself";
  }
  switch (error) {
    case X509_V_ERR_CERT_HAS_EXPIRED:
      return "its certificate has expired: the server needs a new one, or this machine's clock is "
             "wrong";
    case X509_V_ERR_CERT_NOT_YET_VALID:
      return "its certificate is not valid yet: this machine's clock may be wrong";
    default:
      return fmt::format("its certificate is refused: {}", X509_verify_cert_error_string(error));
  }
}

bool is_named(X509* certificate, const std::string& host) {
  if (X509_check_ip_asc(certificate, host.c_str(), 0) == 1) return true;
  const unsigned flags = X509_CHECK_FLAG_NO_PARTIAL_WILDCARDS;
  return X509_check_host(certificate, host.data(), host.size(), flags, nullptr) == 1;
}

}  // namespace

TlsContext load_certificate(const std::string& certificate, const std::string& key) {
  TlsContext context = new_context();
  ERR_clear_error();
  if (SSL_CTX_use_certificate_chain_file(context.get(), certificate.c_str()) != 1) {
    fail(Exit::io,
         "{}: {}; --certificate takes a PEM file with the server's certificate and those "
         "that signed it",
         certificate, last_error());
  }
  if (SSL_CTX_use_PrivateKey_file(context.get(), key.c_str(), SSL_FILETYPE_PEM) == 1)
    return context;
  if (ERR_GET_REASON(ERR_peek_error()) == X509_R_KEY_VALUES_MISMATCH)
    fail(Exit::io, "{}: is not the key to {}; name the two that belong together", key, certificate);
  fail(Exit::io, "{}: {}; --key takes the PEM file of the key to {}, without a passphrase", key,
       last_error(), certificate);
}

bool use_certificate(ssl_ctx_st* to, const TlsContext& from) {
  STACK_OF(X509)* chain = nullptr;
  if (SSL_CTX_get0_chain_certs(from.get(), &chain) != 1) return false;
  return SSL_CTX_use_cert_and_key(to, SSL_CTX_get0_certificate(from.get()),
                                  SSL_CTX_get0_privatekey(from.get()), chain, 1) == 1;
}

bool demand_tls13(ssl_ctx_st* context) {
  SSL_CTX_set_options(context, SSL_OP_NO_RENEGOTIATION);
  return SSL_CTX_set_min_proto_version(context, TLS1_3_VERSION) == 1 &&
         SSL_CTX_set_max_early_data(context, 0) == 1;
}

std::string parse_pin(const std::string& text) {
  constexpr std::string_view kKind = "sha256:";
  std::string digits;
  for (const char c : text.starts_with(kKind) ? text.substr(kKind.size()) : std::string()) {
    if (c != ':') digits += c;  // openssl x509 -fingerprint writes colons.
  }
  const auto pin = from_hex(tools::lower_case(digits));
  if (pin && pin->size() == kPinBytes) return *pin;
  fail(Exit::usage,
       "--pin: expected sha256: and 64 hexadecimal digits, not \"{}\"; openssl x509 -noout "
       "-fingerprint -sha256 -in CERTIFICATE shows them",
       text);
}

void check_trust(const Trust& trust) {
  ERR_clear_error();
  if (trust.ca.empty() || use_trust(new_context().get(), trust)) return;
  fail(Exit::io, "{}: {}; --ca takes a PEM file with certificates of authorities", trust.ca,
       last_error());
}

bool use_trust(ssl_ctx_st* context, const Trust& trust) {
  if (!trust.pin.empty()) return true;
  return trust.ca.empty() ? SSL_CTX_set_default_verify_paths(context) == 1
                          : SSL_CTX_load_verify_file(context, trust.ca.c_str()) == 1;
}

std::string objection(x509_store_ctx_st* chain, bool sound, const std::string& host,
                      const Trust& trust, bool& decided) {
  X509* const own = X509_STORE_CTX_get0_cert(chain);
  if (!trust.pin.empty()) {
    const std::string digest = digest_of(own);
    if (digest != trust.pin) {
      return fmt::format("its certificate is not the one that --pin names, but sha256:{}",
                         to_hex(digest));
    }
  }
  const int error = sound ? X509_V_OK : X509_STORE_CTX_get_error(chain);
  if (!sound && (trust.pin.empty() || !lacks_authority(error))) return explain(error);
  if (!sound) X509_STORE_CTX_set_error(chain, X509_V_OK);
  if (X509_STORE_CTX_get_error_depth(chain) != 0 || !sound) return {};
  if (trust.pin.empty() && !is_named(own, host)) {
    X509_STORE_CTX_set_error(chain, X509_V_ERR_HOSTNAME_MISMATCH);
    return fmt::format(
        "its certificate is for another name than {}: connect to the name that it "
        "has, or --pin it",
        host);
  }
  decided = true;
  return {};
}

}  // namespace gicodec::streaming
