//! One Markdown page: what it holds that can be checked, and its HTML.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use pulldown_cmark::{
    CodeBlockKind, CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd, TextMergeWithOffset, html,
};
use pulldown_latex::config::{DisplayMode, RenderConfig};

use super::Fault;

/// A block of code.
pub struct Block {
    /// Line of its first line of code.
    pub line: usize,
    /// Language after the fence.
    pub language: String,
    /// Code.
    pub text: String,
}

/// A Markdown page, parsed.
pub struct Page {
    /// File, from the root of the repository.
    pub source: PathBuf,
    /// First heading.
    pub title: String,
    /// Anchors of the headings.
    pub anchors: BTreeSet<String>,
    /// Blocks of code.
    pub blocks: Vec<Block>,
    /// Code within lines, with its line.
    pub codes: Vec<(usize, String)>,
    text: String,
}

const MARKDOWN: Options = Options::ENABLE_TABLES
    .union(Options::ENABLE_MATH)
    .union(Options::ENABLE_STRIKETHROUGH)
    .union(Options::ENABLE_FOOTNOTES);

impl Page {
    /// Parses the text of a page.
    pub fn new(source: &Path, text: String) -> Self {
        let mut page = Self {
            source: source.to_path_buf(),
            title: String::new(),
            anchors: BTreeSet::new(),
            blocks: Vec::new(),
            codes: Vec::new(),
            text,
        };
        for (event, line) in page.headed_events() {
            match event {
                Event::Start(Tag::Heading { id: Some(id), .. }) => {
                    page.anchors.insert(id.to_string());
                }
                Event::Start(Tag::CodeBlock(kind)) => {
                    let language = match &kind {
                        CodeBlockKind::Fenced(language) => language.to_string(),
                        CodeBlockKind::Indented => String::new(),
                    };
                    page.blocks.push(Block { line: line + 1, language, text: String::new() });
                }
                Event::Text(code) if line == usize::MAX => {
                    if let Some(block) = page.blocks.last_mut() {
                        block.text.push_str(&code);
                    }
                }
                Event::Code(code) => page.codes.push((line, code.to_string())),
                _ => {}
            }
        }
        page.title = page.first_heading();
        page
    }

    /// The Markdown.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Line of a byte of the text.
    fn line(&self, at: usize) -> usize {
        self.text[..at].matches('\n').count() + 1
    }

    /// Events with their lines; headings have their anchors, text inside blocks of code has the line `usize::MAX`.
    fn headed_events(&self) -> Vec<(Event<'static>, usize)> {
        let merged = TextMergeWithOffset::new(Parser::new_ext(&self.text, MARKDOWN).into_offset_iter());
        let mut events: Vec<(Event<'static>, usize)> = Vec::new();
        let (mut in_block, mut heading, mut words) = (false, None, String::new());
        let mut taken: BTreeSet<String> = BTreeSet::new();
        for (event, range) in merged {
            let line = if in_block && matches!(event, Event::Text(_)) { usize::MAX } else { self.line(range.start) };
            match &event {
                Event::Start(Tag::CodeBlock(_)) => in_block = true,
                Event::End(TagEnd::CodeBlock) => in_block = false,
                Event::Start(Tag::Heading { .. }) => {
                    heading = Some(events.len());
                    words.clear();
                }
                Event::Text(text) | Event::Code(text) | Event::InlineMath(text) => words.push_str(text),
                Event::End(TagEnd::Heading(_)) => {
                    if let Some((Event::Start(Tag::Heading { id, .. }), _)) = heading.take().map(|k| &mut events[k]) {
                        let anchor = free_anchor(&words, &taken);
                        taken.insert(anchor.clone());
                        *id = Some(CowStr::from(anchor));
                    }
                }
                _ => {}
            }
            events.push((event.into_static(), line));
        }
        events
    }

    fn first_heading(&self) -> String {
        let mut inside = false;
        let mut title = String::new();
        for event in Parser::new_ext(&self.text, MARKDOWN) {
            match event {
                Event::Start(Tag::Heading { level: HeadingLevel::H1, .. }) => inside = true,
                Event::End(TagEnd::Heading(_)) if inside => break,
                Event::Text(text) | Event::Code(text) if inside => title.push_str(&text),
                _ => {}
            }
        }
        title
    }

    /// HTML of the page. `relink` gives each link and image its target in the site, `cite` the HTML of a text with citations.
    pub fn html(
        &self,
        relink: &mut dyn FnMut(&str) -> Result<String, String>,
        cite: &dyn Fn(&str) -> Result<Option<String>, String>,
        faults: &mut Vec<Fault>,
    ) -> String {
        let mut fault = |line, message| faults.push(Fault { file: self.source.clone(), line, message });
        let mut events = Vec::new();
        let mut in_link = 0;
        for (event, line) in self.headed_events() {
            events.push(match event {
                Event::Start(Tag::Link { link_type, dest_url, title, id }) => {
                    in_link += 1;
                    let dest_url = relink(&dest_url).map(CowStr::from).unwrap_or_else(|message| {
                        fault(line, message);
                        dest_url
                    });
                    Event::Start(Tag::Link { link_type, dest_url, title, id })
                }
                Event::Start(Tag::Image { link_type, dest_url, title, id }) => {
                    let dest_url = relink(&dest_url).map(CowStr::from).unwrap_or_else(|message| {
                        fault(line, message);
                        dest_url
                    });
                    Event::Start(Tag::Image { link_type, dest_url, title, id })
                }
                Event::End(TagEnd::Link) => {
                    in_link -= 1;
                    Event::End(TagEnd::Link)
                }
                Event::InlineMath(tex) => math(&tex, DisplayMode::Inline).unwrap_or_else(|message| {
                    fault(line, message);
                    Event::Text(tex)
                }),
                Event::DisplayMath(tex) => math(&tex, DisplayMode::Block).unwrap_or_else(|message| {
                    fault(line, message);
                    Event::Text(tex)
                }),
                Event::Text(text) if line != usize::MAX && in_link == 0 => match cite(&text) {
                    Ok(Some(html)) => Event::InlineHtml(CowStr::from(html)),
                    Ok(None) => Event::Text(text),
                    Err(message) => {
                        fault(line, message);
                        Event::Text(text)
                    }
                },
                other => other,
            });
        }
        let mut out = String::new();
        html::push_html(&mut out, events.into_iter());
        // wide tables scroll by themselves
        out.replace("<table>", "<div class=\"table\"><table>").replace("</table>", "</table></div>")
    }
}

/// LaTeX as MathML, which browsers draw without a script or a network.
fn math(tex: &str, display_mode: DisplayMode) -> Result<Event<'static>, String> {
    let storage = pulldown_latex::Storage::new();
    let events = pulldown_latex::Parser::new(tex, &storage)
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| format!("formula ${tex}$: {error}"))?;
    let config = RenderConfig { display_mode, ..RenderConfig::default() };
    let mut out = String::new();
    let events = events.into_iter().map(Ok::<_, std::convert::Infallible>);
    pulldown_latex::push_mathml(&mut out, events, config).map_err(|error| format!("formula ${tex}$: {error}"))?;
    Ok(Event::InlineHtml(CowStr::from(out)))
}

/// Anchor of a heading as code forges make it: lower case, hyphens for spaces, other punctuation dropped, numbered when taken.
fn free_anchor(heading: &str, taken: &BTreeSet<String>) -> String {
    let plain: String = heading
        .to_lowercase()
        .chars()
        .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'))
        .map(|c| if c == ' ' { '-' } else { c })
        .collect();
    std::iter::once(plain.clone())
        .chain((1..).map(|k| format!("{plain}-{k}")))
        .find(|anchor| !taken.contains(anchor))
        .unwrap_or(plain)
}

/// Text that is safe inside HTML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_gives_what_is_checked() {
        let text = "# Title\n\n## A `b`, c!\n\n## A b c\n\nText with `code`.\n\n```sh\nrun me\n```\n";
        let page = Page::new(Path::new("x.md"), text.into());
        assert_eq!(page.title, "Title");
        assert_eq!(page.anchors.iter().map(String::as_str).collect::<Vec<_>>(), ["a-b-c", "a-b-c-1", "title"]);
        assert_eq!(page.codes, [(3, "b".to_owned()), (7, "code".to_owned())]);
        let block = &page.blocks[0];
        assert_eq!((block.line, block.language.as_str(), block.text.as_str()), (10, "sh", "run me\n"));
    }

    #[test]
    fn formulas_become_mathml_and_bad_ones_faults() {
        let page = Page::new(Path::new("x.md"), "$$ \\frac{a}{b} $$\n\nand $\\nonsense{x}$\n".into());
        let mut faults = Vec::new();
        let html = page.html(&mut |link| Ok(link.to_owned()), &|_| Ok(None), &mut faults);
        assert!(html.contains("<mfrac>"), "{html}");
        assert!(faults.len() == 1 && faults[0].line == 3, "{}", faults.len());
    }
}
