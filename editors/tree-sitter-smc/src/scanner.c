// Line ends and units.
//
// An item ends with its line, unless the next line goes on with an operator, a bracket or a word such as `by`. The
// grammar asks for an end only where a line can end: not in brackets, and not behind an operator.

#include "tree_sitter/parser.h"
#include "keywords.h"
#include <string.h>

enum { ITEM_END, UNIT, POINT_UNIT, ERROR };
enum { SIZE = 16 };  // longer than every word of the tables

static const char *const INFIX[] = {"in", "U", "W", "R", 0};

static void step(TSLexer *lexer) { lexer->advance(lexer, false); }
static bool is_blank(int32_t c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == 0xFEFF; }
static bool is_digit(int32_t c) { return c >= '0' && c <= '9'; }
static bool is_symbol(int32_t c) { return c >= 0x2190 && c <= 0x22FF; }  // arrows and operators such as ≤
static bool is_letter(int32_t c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || (c > 0xAC && c != 0xFEFF && !is_symbol(c));
}

static void read_word(TSLexer *lexer, char word[SIZE]) {
    unsigned length = 0;
    for (; is_letter(lexer->lookahead) || is_digit(lexer->lookahead); step(lexer))
        if (length < SIZE - 1) word[length++] = lexer->lookahead < 0x80 ? (char)lexer->lookahead : '?';
    word[length] = 0;
}

static bool is_in(const char *word, const char *const *table) {
    while (*table && strcmp(word, *table) != 0) table++;
    return *table;
}

// Skips blanks and comments, and says whether a line ended. A slash that begins no comment is consumed. With `leading`
// a token does not include the blanks.
static bool skip_trivia(TSLexer *lexer, bool leading, bool *comment, bool *slash) {
    for (bool ended = false;; *comment = true) {
        for (; is_blank(lexer->lookahead); lexer->advance(lexer, leading)) ended |= lexer->lookahead == '\n';
        if (lexer->lookahead != '/') return ended;
        step(lexer);
        bool block = lexer->lookahead == '*';
        if (!block && lexer->lookahead != '/') {
            *slash = true;
            return ended;
        }
        step(lexer);
        for (int32_t last = 0; !lexer->eof(lexer); step(lexer)) {
            if (block ? last == '*' && lexer->lookahead == '/' : lexer->lookahead == '\n') break;
            last = lexer->lookahead;
            ended |= last == '\n';
        }
        if (block) step(lexer);
    }
}

// Whether the line that begins here goes on with the item before.
static bool goes_on(TSLexer *lexer) {
    int32_t first = lexer->lookahead;
    if (is_symbol(first) || (first < 0x80 && memchr("+-*^<>&|,()]{", first, 13))) return true;
    if (first == '=' || first == '!' || first == '.') {
        step(lexer);
        return lexer->lookahead == (first == '.' ? '.' : '=') || (first == '=' && lexer->lookahead == '>');
    }
    char word[SIZE];
    read_word(lexer, word);
    bool infix = is_in(word, INFIX);
    if (!infix && !is_in(word, CONTINUES)) return false;
    bool comment = false, slash = false;  // a field may have such a name: `radius = 0.3 m`
    skip_trivia(lexer, true, &comment, &slash);
    if (slash || lexer->lookahead != '=') return slash || infix || lexer->lookahead != ':';
    step(lexer);
    return lexer->lookahead == '=' || lexer->lookahead == '>';
}

// The name of a unit and its exponent: `m`, `s^2`. With `mark` the token ends behind it.
static bool scan_factor(TSLexer *lexer, bool mark, bool *minutes) {
    char word[SIZE];
    read_word(lexer, word);
    if (!is_in(word, UNITS)) return false;
    *minutes = strcmp(word, "min") == 0;
    if (mark) lexer->mark_end(lexer);
    if (lexer->lookahead != '^') return true;
    step(lexer);
    if (lexer->lookahead == '-') step(lexer);
    while (is_digit(lexer->lookahead)) {
        step(lexer);
        if (mark) lexer->mark_end(lexer);
    }
    return true;
}

// What follows a slash: `s`, `(m s)`.
static bool scan_divisor(TSLexer *lexer, bool *minutes) {
    if (lexer->lookahead != '(') return scan_factor(lexer, true, minutes);
    step(lexer);
    for (bool comment = false, slash = false;;) {
        skip_trivia(lexer, false, &comment, &slash);
        if (lexer->lookahead == ')') break;
        if (lexer->lookahead == '*') step(lexer);
        else if (slash || !scan_factor(lexer, false, minutes)) return false;
    }
    *minutes = false;
    step(lexer);
    lexer->mark_end(lexer);
    return true;
}

// A unit of several factors: `m/s`, `kg /(m s)`. It is part of its number, so `1 /s` and `1 / s` differ. A name that
// is set (`s = 1`) or has a member (`s.n`) is none.
static bool scan_unit(TSLexer *lexer, bool slash) {
    for (bool first = true;; first = false) {
        bool minutes = false;
        if (!(slash ? scan_divisor(lexer, &minutes) : scan_factor(lexer, true, &minutes))) return !first;
        bool joined = !is_blank(lexer->lookahead);
        while (is_blank(lexer->lookahead)) step(lexer);
        int32_t next = lexer->lookahead;
        slash = next == '/';
        if (!slash && !(joined && next == '*') && next != '.' && next != '=' && next != '<')
            return !minutes || !joined || (next != '(' && next != '[' && next != 0x2264);
        step(lexer);
        if (next == '.') return !first || !joined || !is_letter(lexer->lookahead);
        if (next == '=') return !first || lexer->lookahead == '=' || lexer->lookahead == '>';
        // `min<=10 s` is a minimum over time.
        if (next == '<') return !minutes || !joined || lexer->lookahead != '=';
    }
}

bool tree_sitter_smc_external_scanner_scan(void *payload, TSLexer *lexer, const bool *valid) {
    if (valid[ERROR]) return false;
    lexer->mark_end(lexer);
    bool comment = false, slash = false;
    bool ended = skip_trivia(lexer, true, &comment, &slash);
    bool last = !slash && (lexer->eof(lexer) || lexer->lookahead == '}');
    lexer->result_symbol = valid[UNIT] ? UNIT : valid[POINT_UNIT] ? POINT_UNIT : ITEM_END;
    if (valid[ITEM_END] && !slash && (ended || last)) {
        lexer->result_symbol = ITEM_END;
        return last || !goes_on(lexer);
    }
    if (comment || lexer->result_symbol == ITEM_END || (slash && !valid[UNIT])) return false;
    if (!valid[UNIT] || slash || lexer->lookahead != '%') return scan_unit(lexer, slash);
    step(lexer);
    lexer->mark_end(lexer);
    return true;
}

void *tree_sitter_smc_external_scanner_create(void) { return 0; }
void tree_sitter_smc_external_scanner_destroy(void *payload) {}
unsigned tree_sitter_smc_external_scanner_serialize(void *payload, char *buffer) { return 0; }
void tree_sitter_smc_external_scanner_deserialize(void *payload, const char *buffer, unsigned length) {}
