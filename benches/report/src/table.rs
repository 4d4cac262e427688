//! What was measured, line by line.

use std::{
    fs::File,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use crate::{ReportError, scenes::Scene};

/// What the table is called.
const FILE: &str = "speed_error.csv";

/// One value. The columns of the CSV, in this order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Name of the scene.
    pub scene: String,
    /// Number of its particles.
    pub particles: usize,
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// Name of the method.
    pub method: String,
    /// Its parameters, where it has any that vary.
    pub parameters: String,
    /// What was measured.
    pub quantity: String,
    /// Where in the picture: `all`, `interior`, `silhouette`, `grazing`.
    pub region: String,
    /// How much.
    pub value: f64,
    /// Of what: `ms`, `r` (particle radii), `deg`, `1` …
    pub unit: String,
}

/// All values of a run.
#[derive(Clone, Debug, Default)]
pub struct Table {
    rows: Vec<Row>,
}

/// What a value says something about.
#[derive(Clone, Copy)]
pub(crate) struct Subject<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) method: &'a str,
    pub(crate) parameters: &'a str,
}

impl Table {
    /// The rows in the order they were measured.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    pub(crate) fn push(&mut self, row: Row) {
        self.rows.push(row);
    }

    pub(crate) fn add(
        &mut self,
        of: Subject,
        quantity: &'static str,
        region: &'static str,
        value: f64,
        unit: &'static str,
    ) {
        self.push(Row {
            scene: of.scene.name.into(),
            particles: of.scene.positions.len(),
            width: of.scene.camera.size.x,
            height: of.scene.camera.size.y,
            method: of.method.into(),
            parameters: of.parameters.into(),
            quantity: quantity.into(),
            region: region.into(),
            value,
            unit: unit.into(),
        });
    }

    /// The value of a quantity, if it was measured.
    pub fn value(
        &self,
        scene: &str,
        (method, parameters): (&str, &str),
        quantity: &str,
        region: &str,
    ) -> Option<f64> {
        let row = self.rows.iter().find(|row| {
            row.scene == scene
                && row.method == method
                && row.parameters == parameters
                && row.quantity == quantity
                && row.region == region
        });
        row.map(|row| row.value)
    }

    /// Scenes in the order they were measured.
    pub(crate) fn scenes(&self) -> Vec<&str> {
        let mut scenes: Vec<_> = self.rows.iter().map(|row| row.scene.as_str()).collect();
        scenes.dedup();
        scenes
    }

    /// Methods with their parameters for which a scene has a quantity, in order.
    pub(crate) fn methods(&self, scene: &str, quantity: &str) -> Vec<(String, String)> {
        let rows = self.rows.iter();
        let mut methods: Vec<_> = rows
            .filter(|row| row.scene == scene && row.quantity == quantity)
            .map(|row| (row.method.clone(), row.parameters.clone()))
            .collect();
        methods.dedup();
        methods
    }

    /// Whether a table was written to a folder.
    pub(crate) fn is_in(folder: &Path) -> bool {
        folder.join(FILE).exists()
    }

    /// Takes over the rows of a table that was written to a folder.
    pub(crate) fn read(&mut self, folder: &Path) -> Result<(), ReportError> {
        let path = folder.join(FILE);
        let rows = csv::Reader::from_path(&path)
            .and_then(|mut reader| reader.deserialize().collect::<Result<Vec<Row>, _>>());
        let rows = rows.map_err(|error| ReportError::Part {
            path,
            reason: error.to_string(),
        })?;
        self.rows.extend(rows);
        Ok(())
    }

    pub(crate) fn write(&self, folder: &Path) -> Result<PathBuf, ReportError> {
        let path = folder.join(FILE);
        let failed = |source| ReportError::Write {
            path: path.clone(),
            source,
        };
        let file = File::create(&path).map_err(failed)?;
        let mut writer = csv::Writer::from_writer(file);
        for row in &self.rows {
            writer
                .serialize(row)
                .map_err(|error| failed(std::io::Error::other(error)))?;
        }
        writer.flush().map_err(failed)?;
        Ok(path)
    }
}
