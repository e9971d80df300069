//! Lines of an input file joined to blocks: a keyword with its parameters, and the data lines that follow.

use crate::housing::error::HousingError;

/// A keyword and its data.
#[derive(Debug)]
pub(super) struct Block {
    /// Line of the keyword, from 1.
    pub(super) line: usize,
    /// Keyword in upper case, without the star.
    pub(super) keyword: String,
    /// Parameters: name in upper case, value in lower case (empty of a flag).
    parameters: Vec<(String, String)>,
    /// Data lines with their numbers, split at commas, without empty ends.
    pub(super) data: Vec<(usize, Vec<String>)>,
}

impl Block {
    pub(super) fn fault<T>(&self, message: String) -> Result<T, HousingError> {
        fault(self.line, message)
    }

    pub(super) fn parameter(&self, name: &str) -> Option<&str> {
        self.parameters.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    pub(super) fn needed(&self, name: &str) -> Result<&str, HousingError> {
        match self.parameter(name) {
            Some(value) if !value.is_empty() => Ok(value),
            _ => self.fault(format!("*{} needs the parameter {name}=", self.keyword)),
        }
    }

    /// Refuses parameters that are not among those understood.
    pub(super) fn only(&self, names: &[&str]) -> Result<(), HousingError> {
        match self.parameters.iter().find(|(name, _)| !names.contains(&name.as_str())) {
            Some((name, _)) => self.fault(format!(
                "parameter {name} of *{} is not understood; understood: {}",
                self.keyword,
                names.join(", ")
            )),
            None => Ok(()),
        }
    }
}

pub(super) fn fault<T>(line: usize, message: String) -> Result<T, HousingError> {
    Err(HousingError::File { line, message })
}

/// Blocks of a text, up to the first step.
pub(super) fn blocks(text: &str) -> Result<Vec<Block>, HousingError> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut lines =
        text.lines().enumerate().map(|(k, line)| (k + 1, line.trim())).filter(|(_, line)| !line.starts_with("**"));
    while let Some((line, content)) = lines.next() {
        if let Some(keyword) = content.strip_prefix('*') {
            let mut whole = keyword.to_owned();
            // a keyword line that ends with a comma goes on
            while whole.ends_with(',') {
                match lines.next() {
                    Some((_, more)) => whole.push_str(more),
                    None => break,
                }
            }
            let mut parts = whole.split(',').map(str::trim).filter(|part| !part.is_empty());
            let keyword =
                parts.next().unwrap_or_default().split_whitespace().collect::<Vec<_>>().join(" ").to_uppercase();
            if keyword == "STEP" {
                break;
            }
            let parameter = |part: &str| {
                let (name, value) = part.split_once('=').unwrap_or((part, ""));
                (name.trim().to_uppercase(), value.trim().trim_matches('"').to_lowercase())
            };
            let parameters = parts.map(parameter).collect();
            blocks.push(Block { line, keyword, parameters, data: Vec::new() });
        } else if !content.is_empty() {
            let mut fields: Vec<String> = content.split(',').map(|field| field.trim().to_owned()).collect();
            while fields.last().is_some_and(String::is_empty) {
                fields.pop();
            }
            match blocks.last_mut() {
                Some(block) => block.data.push((line, fields)),
                None => return fault(line, format!("data `{content}` before the first keyword")),
            }
        }
    }
    Ok(blocks)
}
