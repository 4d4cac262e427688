//! Where each method does worst.

use crate::Table;

use super::markdown::Rows;

/// For each smoothing the scene and region in which its normals are farthest from those of the
/// best method there, and where its surface is roughest.
pub(super) fn text(table: &Table) -> String {
    let mut names: Vec<String> = table
        .scenes()
        .into_iter()
        .flat_map(|scene| table.methods(scene, "normal_p95"))
        .map(|(method, _)| method)
        .collect();
    names.sort();
    names.dedup();
    if names.is_empty() {
        return String::new();
    }
    let mut rows = Rows::new([
        "method, at its best parameters",
        "normals p95 worst",
        "in degrees",
        "best method there",
        "roughest",
        "in r",
        "best there",
    ]);
    for name in names {
        let normals = worst(table, &name, "normal_p95");
        let rough = worst(table, &name, "surface_roughness");
        let cells = [normals, rough].into_iter().flatten().flat_map(|worst| {
            [
                worst.place,
                super::markdown::number(Some(worst.own)),
                super::markdown::number(Some(worst.best)),
            ]
        });
        rows.add(&[name].into_iter().chain(cells).collect::<Vec<_>>());
    }
    rows.finish()
}

struct Worst {
    place: String,
    own: f64,
    best: f64,
}

/// Where a method, with the parameters that suit the place best, is farthest behind the best.
fn worst(table: &Table, name: &str, quantity: &'static str) -> Option<Worst> {
    let mut found: Option<Worst> = None;
    for scene in table.scenes() {
        for region in ["interior", "silhouette", "grazing"] {
            let least = |wanted: &dyn Fn(&str) -> bool| {
                let rows = table.rows().iter().filter(|row| {
                    row.scene == scene
                        && row.quantity == quantity
                        && row.region == region
                        && wanted(&row.method)
                });
                rows.map(|row| row.value).reduce(f64::min)
            };
            let (Some(own), Some(best)) = (least(&|method| method == name), least(&|_| true))
            else {
                continue;
            };
            if found.as_ref().is_none_or(|f| own - best > f.own - f.best) {
                found = Some(Worst {
                    place: format!("{scene}, {region}"),
                    own,
                    best,
                });
            }
        }
    }
    found
}
