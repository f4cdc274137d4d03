// Certificates and who may be trusted, with OpenSSL: TLS 1.3 and nothing older.
#pragma once

#include "transport.h"

#include <memory>
#include <string>

struct ssl_ctx_st;
struct x509_store_ctx_st;

namespace gicodec::streaming {

using TlsContext = std::shared_ptr<ssl_ctx_st>;

/// The server's certificate, what signed it, and its key. Throws tools::Error that names the file.
[[nodiscard]] TlsContext load_certificate(const std::string& certificate, const std::string& key);
/// Connections of `to` that begin from now on use the certificate of `from`; false if they cannot.
[[nodiscard]] bool use_certificate(ssl_ctx_st* to, const TlsContext& from);
/// No older protocol, no renegotiation, no early data.
[[nodiscard]] bool demand_tls13(ssl_ctx_st* context);

/// The 32 bytes of "sha256:HEX". Throws tools::Error of Exit::usage.
[[nodiscard]] std::string parse_pin(const std::string& text);
/// What a client accepts. Throws tools::Error of Exit::bad_input or io for a file of authorities.
void check_trust(const Trust& trust);
[[nodiscard]] bool use_trust(ssl_ctx_st* context, const Trust& trust);
/// Why the certificate that is being looked at is refused, empty if it is not. To be asked for each
/// in the chain; errors that a pin makes void are cleared. `decided`: the server's own was judged.
[[nodiscard]] std::string objection(x509_store_ctx_st* chain, bool sound, const std::string& host,
                                    const Trust& trust, bool& decided);

}  // namespace gicodec::streaming
