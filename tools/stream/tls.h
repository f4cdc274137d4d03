// Certificates and trust, with OpenSSL: TLS 1.3 and nothing older.
#pragma once

#include "transport.h"

#include <memory>
#include <string>

struct ssl_ctx_st;
struct x509_store_ctx_st;

namespace gicodec::streaming {

using TlsContext = std::shared_ptr<ssl_ctx_st>;

/// Loads the server's certificate, its chain, and its key. Throws tools::Error that names the file.
[[nodiscard]] TlsContext load_certificate(const std::string& certificate, const std::string& key);
/// Makes new connections of `to` use the certificate of `from`; false if that fails.
[[nodiscard]] bool use_certificate(ssl_ctx_st* to, const TlsContext& from);
/// Allows no older protocol, no renegotiation, no early data.
[[nodiscard]] bool demand_tls13(ssl_ctx_st* context);

/// The 32 bytes of "sha256:HEX". Throws tools::Error of Exit::usage.
[[nodiscard]] std::string parse_pin(const std::string& text);
/// Checks a client's file of authorities. Throws tools::Error of Exit::bad_input or Exit::io.
void check_trust(const Trust& trust);
[[nodiscard]] bool use_trust(ssl_ctx_st* context, const Trust& trust);
/// The reason to refuse the certificate being verified; empty: none. Call it for each certificate
/// of the chain. It clears errors that a pin makes void. `decided`: the server's own was judged.
[[nodiscard]] std::string objection(x509_store_ctx_st* chain, bool sound, const std::string& host,
                                    const Trust& trust, bool& decided);

}  // namespace gicodec::streaming
