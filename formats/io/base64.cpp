#include "formats/io/base64.h"

#include <nettle/base64.h>

namespace evo {

std::string base64(std::string_view bytes) {
  std::string text(BASE64_ENCODE_RAW_LENGTH(bytes.size()), '\0');
  base64_encode_raw(text.data(), bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data()));
  return text;
}

std::optional<std::vector<std::uint8_t>> from_base64(std::string_view text) {
  base64_decode_ctx decoder;
  base64_decode_init(&decoder);
  std::vector<std::uint8_t> bytes(BASE64_DECODE_LENGTH(text.size()));
  std::size_t length = bytes.size();
  if (base64_decode_update(&decoder, &length, bytes.data(), text.size(), text.data()) != 1 ||
      base64_decode_final(&decoder) != 1)
    return std::nullopt;
  bytes.resize(length);
  return bytes;
}

}  // namespace evo
