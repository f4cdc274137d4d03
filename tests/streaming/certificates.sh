# For tests of TLS: makes an authority, a server's certificate from it and others that are wrong.
# certificate NAME SUBJECT-ALTERNATIVE-NAME [DAYS]: NAME.pem and NAME.key from the authority.
authority() {
  openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 30 \
    -subj "/CN=$1" -keyout "$1.key" -out "$1.pem" 2>/dev/null || failed "no authority $1"
}
certificate() {
  openssl req -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -subj "/CN=$1" \
    -keyout "$1.key" -out "$1.request" 2>/dev/null
  openssl x509 -req -in "$1.request" -CA authority.pem -CAkey authority.key -CAcreateserial \
    -days "${3:-30}" -extfile <(echo "subjectAltName=$2") -out "$1.pem" 2>/dev/null ||
    failed "no certificate $1"
}
pin_of() { openssl x509 -noout -fingerprint -sha256 -in "$1" | sed 's/.*=/sha256:/'; }

authority authority
authority stranger
certificate server DNS:localhost,IP:127.0.0.1,IP:::1
certificate other DNS:elsewhere.example
certificate expired DNS:localhost,IP:127.0.0.1 -1
