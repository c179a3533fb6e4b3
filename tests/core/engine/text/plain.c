/* Text of unknown origin: what is UTF-8 stays, what could command a terminal is shown. */
#include "core/engine/text/text.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static void shows(const char *text, const char *wanted) {
  char plain[64];
  hk_plain_copy(plain, sizeof plain, text);
  assert_string_equal(plain, wanted);
}

static void letters_and_line_breaks_stay(void **state) {
  (void)state;
  shows("speed, m/s\n\ta", "speed, m/s\n\ta");
  shows("Größe µ 力 \U0001F600", "Größe µ 力 \U0001F600");
}

static void in_one_line_line_breaks_are_shown(void **state) {
  (void)state;
  char plain[64];
  hk_plain_line(plain, sizeof plain, "x\n  verdict\tok\033 µ");
  assert_string_equal(plain, "x\\x0a  verdict\\x09ok\\x1b µ");
}

static void commands_are_shown(void **state) {
  (void)state;
  shows("\033[2J\a\b\r\x7f", "\\x1b[2J\\x07\\x08\\x0d\\x7f");
  shows("\xc2\x9b"
        "2J",
        "\\x9b2J");                              /* C1: CSI */
  shows("\u202ex\u2066", "\\u{202e}x\\u{2066}"); /* orders of writing direction */
}

/* RFC 3629, section 3: no overlong forms, no surrogates, nothing above U+10FFFF; and sequences that are cut. */
static void what_is_no_utf8_is_shown_byte_by_byte(void **state) {
  (void)state;
  shows("\xff", "\\xff");
  shows("\xc0\x80", "\\xc0\\x80");
  shows("\xe0\x80\xaf", "\\xe0\\x80\\xaf");
  shows("\xed\xa0\x80", "\\xed\\xa0\\x80");
  shows("\xf4\x90\x80\x80", "\\xf4\\x90\\x80\\x80");
  shows("\xf8\x88\x80\x80\x80", "\\xf8\\x88\\x80\\x80\\x80");
  shows("a\xe2\x82", "a\\xe2\\x82");
  shows("\xf4\x8f\xbf\xbf", "\xf4\x8f\xbf\xbf"); /* U+10FFFF, the last */
}

/* The copy is cut between characters. */
static void a_copy_fits(void **state) {
  (void)state;
  for (size_t size = 1; size < 12; size++) {
    char plain[12];
    memset(plain, '!', sizeof plain);
    hk_plain_copy(plain, size, "ab\x01力c");
    uint32_t code;
    assert_true(strlen(plain) < size);
    for (const char *c = plain; *c; c += hk_utf8_next(c, &code)) assert_true(hk_utf8_next(c, &code) > 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(letters_and_line_breaks_stay),
      cmocka_unit_test(in_one_line_line_breaks_are_shown),
      cmocka_unit_test(commands_are_shown),
      cmocka_unit_test(what_is_no_utf8_is_shown_byte_by_byte),
      cmocka_unit_test(a_copy_fits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
