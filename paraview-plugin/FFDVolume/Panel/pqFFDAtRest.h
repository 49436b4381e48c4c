// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef pqFFDAtRest_h
#define pqFFDAtRest_h

#include <QObject>
#include <QPointer>

class QLabel;
class QTimer;
class pqFFDAtRestMarks;
class pqView;

/**
 * Says where the active view shows data with a lattice at rest, as ParaView's own "Volume", "Slice"
 * and "Point Gaussian" do: a mark beside the name in the pipeline browser, and a text in the status
 * bar, for as long as it is so. The tooltips of both say what to do.
 */
class pqFFDAtRest : public QObject
{
  Q_OBJECT

public:
  pqFFDAtRest(QObject* parent = nullptr);
  ~pqFFDAtRest() override;

  /// Called by ParaView when the plugin is loaded and unloaded.
  void startup();
  void shutdown();

private Q_SLOTS:
  void watch(pqView* view);
  void refresh();

private:
  Q_DISABLE_COPY(pqFFDAtRest)

  void findWidgets();

  QTimer* Soon; // one refresh for all that happens at once
  QPointer<pqView> View;
  QPointer<QLabel> Label;
  QPointer<pqFFDAtRestMarks> Marks;
};

#endif
