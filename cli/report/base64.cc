// SPDX-License-Identifier: Apache-2.0
#include "cli/report/base64.h"

#include <openssl/evp.h>
#include <openssl/sha.h>

#include <array>

namespace rsstab::report {

std::string Base64(std::span<const std::uint8_t> bytes) {
  // OpenSSL takes an int and adds a terminating zero; whole groups of three can be joined.
  constexpr std::size_t kPiece = std::size_t{3} << 20U;
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  std::string piece(kPiece / 3 * 4 + 1, '\0');
  while (!bytes.empty()) {
    const auto part = bytes.first(std::min(kPiece, bytes.size()));
    bytes = bytes.subspan(part.size());
    const int length = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(piece.data()), part.data(),
                                       static_cast<int>(part.size()));
    text.append(piece, 0, static_cast<std::size_t>(length));
  }
  return text;
}

std::string CspHash(std::string_view script) {
  std::array<std::uint8_t, SHA256_DIGEST_LENGTH> digest{};
  SHA256(reinterpret_cast<const unsigned char*>(script.data()), script.size(), digest.data());
  return "'sha256-" + Base64(digest) + "'";
}

}  // namespace rsstab::report
